"""One step of the controller: the stages of the paper in their order."""

from __future__ import annotations

from typing import NamedTuple

from costeer.base import array as xp
from costeer.base.array import Flag, Real, compiled
from costeer.controller import (
    actuation,
    consistency,
    guidance,
    hands,
    inference,
    preview,
    replanning,
    strength,
    trajectory,
)
from costeer.controller.actuation import ActuationParameters, ActuationState
from costeer.controller.consistency import ConsistencyParameters, ConsistencyState
from costeer.controller.guidance import GuidanceParameters
from costeer.controller.hands import HandsParameters, HandsState
from costeer.controller.inference import InferenceParameters, InferenceState
from costeer.controller.preview import PreviewParameters
from costeer.controller.replanning import ReplanningParameters
from costeer.controller.signals import (
    Assistance,
    Consistency,
    Guidance,
    Intention,
    Preview,
    Request,
    Target,
)
from costeer.controller.strength import StrengthParameters, StrengthState
from costeer.controller.trajectory import TrajectoryParameters, TrajectoryState
from costeer.plant.parameters import CarParameters, ColumnParameters, RoadParameters
from costeer.sensing.measurement import Measurement


class ControllerParameters(NamedTuple):
    """All stages, and the nominal car, column and road that the controller knows.

    Attributes:
        car: Nominal car [SI units]. Source: plant/parameters.py.
        column: Nominal column [SI units]. Source: plant/parameters.py.
        road: Lanes [SI units]. Source: plant/parameters.py.
        inference: Trigger and lock [SI units]. Source: Sec. II-B.
        trajectory: Duration of a lane change [SI units]. Source: Eq. (3).
        preview: Preview time [SI units]. Source: Fig. 4.
        guidance: Gains [SI units]. Source: Eq. (5).
        consistency: Threshold [SI units]. Source: Table III.
        hands: Relaxed arms [SI units]. Source: controller/hands.py.
        strength: Fade [SI units]. Source: Eqs. (10) and (11).
        replanning: When to plan anew [SI units]. Source: Sec. II-E.
        actuation: Strength and limits [SI units]. Source: Eq. (6), Table IV.
    """

    car: CarParameters = CarParameters()
    column: ColumnParameters = ColumnParameters()
    road: RoadParameters = RoadParameters()
    inference: InferenceParameters = InferenceParameters()
    trajectory: TrajectoryParameters = TrajectoryParameters()
    preview: PreviewParameters = PreviewParameters()
    guidance: GuidanceParameters = GuidanceParameters()
    consistency: ConsistencyParameters = ConsistencyParameters()
    hands: HandsParameters = HandsParameters()
    strength: StrengthParameters = StrengthParameters()
    replanning: ReplanningParameters = ReplanningParameters()
    actuation: ActuationParameters = ActuationParameters()


class ControllerState(NamedTuple):
    """All that the stages remember.

    Attributes:
        inference: Trigger and lock.
        trajectory: Mode and plan.
        consistency: Pseudo-work windows.
        hands: The wheel at the step before.
        strength: Fade.
        actuation: Last torque.
        replan: Whether the step before called for a new plan.
    """

    inference: InferenceState
    trajectory: TrajectoryState
    consistency: ConsistencyState
    hands: HandsState
    strength: StrengthState
    actuation: ActuationState
    replan: Flag


@compiled
def initial_state(parameters: ControllerParameters, lane: Real) -> ControllerState:
    """Lane keeping in `lane`, full gain, consistent."""
    return ControllerState(
        inference=inference.initial_state(),
        trajectory=trajectory.initial_state(parameters.road, lane),
        consistency=consistency.initial_state(),
        hands=hands.initial_state(),
        strength=strength.initial_state(),
        actuation=actuation.initial_state(),
        replan=False,
    )


@compiled
def plan(
    parameters: ControllerParameters,
    state: ControllerState,
    measurement: Measurement,
    request: Request,
    dt: Real,
) -> tuple[InferenceState, Intention, TrajectoryState, Target]:
    """Infer the intention, choose mode and path.

    A lane change that is asked for counts as an intention.
    """
    own = parameters.trajectory
    duration = xp.select(
        xp.isfinite(request.change_duration),
        request.change_duration,
        own.change_duration,
    )
    inference_state, inferred = inference.step(
        parameters.inference,
        state.inference,
        parameters.road,
        measurement,
        request.crossing_probability,
        state.trajectory.path_ended,
        dt,
    )
    intention = Intention(
        detected=inferred.detected | request.requested, side=inferred.side
    )
    trajectory_state, target = trajectory.step(
        own._replace(change_duration=duration),
        state.trajectory,
        parameters.road,
        measurement,
        intention,
        state.consistency.consistent,
        state.replan,
    )
    return inference_state, intention, trajectory_state, target


@compiled
def instruct(
    parameters: ControllerParameters, target: Target, measurement: Measurement
) -> tuple[Preview, Guidance]:
    """Errors at the preview point and the torques they call for."""
    errors = preview.preview(parameters.preview, parameters.car, target, measurement)
    gains = guidance.at_speed(parameters.guidance, measurement.longitudinal_velocity)
    torques = guidance.guide(gains, parameters.car, parameters.column, errors)
    return errors, torques


@compiled
def judge(
    parameters: ControllerParameters,
    state: ControllerState,
    measurement: Measurement,
    errors: Preview,
    torques: Guidance,
    dt: Real,
) -> tuple[HandsState, ConsistencyState, Consistency]:
    """Whether driver and system want the same path."""
    hands_state, own_torque = hands.step(parameters.hands, state.hands, measurement, dt)
    consistency_state, verdict = consistency.step(
        parameters.consistency,
        state.consistency,
        torques.instructed_torque,
        measurement.driver_torque,
        errors.heading_error_rate,
        dt,
        own_torque,
    )
    return hands_state, consistency_state, verdict


@compiled
def step(
    parameters: ControllerParameters,
    state: ControllerState,
    measurement: Measurement,
    request: Request,
    dt: Real,
) -> tuple[ControllerState, Assistance]:
    """Run all stages once; return the state and everything they computed.

    Args:
        parameters: Of all stages.
        state: Of all stages.
        measurement: This step's sample.
        request: Verdict of the predictor and what is asked for from outside.
        dt: Control step [s].
    """
    inference_state, intention, trajectory_state, target = plan(
        parameters, state, measurement, request, dt
    )
    errors, torques = instruct(parameters, target, measurement)
    hands_state, consistency_state, verdict = judge(
        parameters, state, measurement, errors, torques, dt
    )
    strength_state, gain = strength.step(
        parameters.strength, state.strength, verdict.consistent, dt
    )
    replan = replanning.replan(parameters.replanning, gain, verdict.consistent)
    felt = actuation.felt_instruction(torques, measurement.driver_torque)
    actuation_state, torque = actuation.step(
        parameters.actuation, state.actuation, gain, felt, dt
    )
    new_state = ControllerState(
        inference=inference_state,
        trajectory=trajectory_state,
        consistency=consistency_state,
        hands=hands_state,
        strength=strength_state,
        actuation=actuation_state,
        replan=replan,
    )
    return new_state, Assistance(
        applied_torque=torque,
        haptic_gain=gain,
        intention=intention.detected,
        target=target,
        preview=errors,
        guidance=torques,
        consistency=verdict,
        replan=replan,
    )
