"""One step of the controller: the stages of the paper in their order."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple, Protocol

from costeer.base import array as xp
from costeer.base.array import Flag, Real, compiled, inlined
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


class Planning(Protocol):
    """Parameters of a method that infers an intention and plans paths."""

    @property
    def road(self) -> RoadParameters: ...  # noqa: D102
    @property
    def inference(self) -> InferenceParameters: ...  # noqa: D102
    @property
    def trajectory(self) -> TrajectoryParameters: ...  # noqa: D102


class Planned(Protocol):
    """What such a method remembers."""

    @property
    def inference(self) -> InferenceState: ...  # noqa: D102
    @property
    def trajectory(self) -> TrajectoryState: ...  # noqa: D102
    @property
    def replan(self) -> Flag: ...  # noqa: D102


class Guiding(Protocol):
    """Parameters of a method that guides to a target by Eqs. (4) and (5)."""

    @property
    def car(self) -> CarParameters: ...  # noqa: D102
    @property
    def column(self) -> ColumnParameters: ...  # noqa: D102
    @property
    def preview(self) -> PreviewParameters: ...  # noqa: D102
    @property
    def guidance(self) -> GuidanceParameters: ...  # noqa: D102


@compiled
def lasting(own: TrajectoryParameters, request: Request) -> TrajectoryParameters:
    """How a lane change is planned now: as long as is asked for, or the usual."""
    asked = request.change_duration
    duration = xp.select(xp.isfinite(asked), asked, own.change_duration)
    return own._replace(change_duration=duration)


@compiled
def plan(
    parameters: Planning,
    state: Planned,
    measurement: Measurement,
    request: Request,
    consistent: Flag,
    dt: Real,
) -> tuple[InferenceState, Intention, TrajectoryState, Target]:
    """Infer the intention, choose mode and path.

    A lane change that is asked for counts as an intention.

    Args:
        parameters: Trigger, paths and road.
        state: Trigger, plan, and whether the step before called for a new one.
        measurement: This step's sample.
        request: Verdict of the predictor and what is asked for from outside.
        consistent: Verdict of the step before.
        dt: Control step [s].
    """
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
        lasting(parameters.trajectory, request),
        state.trajectory,
        parameters.road,
        measurement,
        intention,
        consistent,
        state.replan,
    )
    return inference_state, intention, trajectory_state, target


@compiled
def instruct(
    parameters: Guiding, target: Target, measurement: Measurement
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
    rate: Real,
    torques: Guidance,
    dt: Real,
) -> tuple[HandsState, ConsistencyState, Consistency]:
    """Whether driver and system want the same path.

    Args:
        parameters: Of all stages.
        state: Of all stages.
        measurement: This step's sample.
        rate: What both torques are multiplied by in Eqs. (7) and (8).
        torques: Of the guidance.
        dt: Control step [s].
    """
    hands_state, own_torque = hands.step(parameters.hands, state.hands, measurement, dt)
    consistency_state, verdict = consistency.step(
        parameters.consistency,
        state.consistency,
        torques.instructed_torque,
        measurement.driver_torque,
        rate,
        dt,
        own_torque,
    )
    return hands_state, consistency_state, verdict


@inlined
def step_by(
    rate_of: Callable[[Measurement, Preview], Real],
    parameters: ControllerParameters,
    state: ControllerState,
    measurement: Measurement,
    request: Request,
    dt: Real,
) -> tuple[ControllerState, Assistance]:
    """Run all stages once; return the state and everything they computed.

    Args:
        rate_of: What both torques are multiplied by in Eqs. (7) and (8).
        parameters: Of all stages.
        state: Of all stages.
        measurement: This step's sample.
        request: Verdict of the predictor and what is asked for from outside.
        dt: Control step [s].
    """
    inference_state, intention, trajectory_state, target = plan(
        parameters, state, measurement, request, state.consistency.consistent, dt
    )
    errors, torques = instruct(parameters, target, measurement)
    hands_state, consistency_state, verdict = judge(
        parameters, state, measurement, rate_of(measurement, errors), torques, dt
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


@compiled
def heading_error_rate(measurement: Measurement, errors: Preview) -> Real:
    """e_theta' [rad/s], by which the paper judges a torque."""
    return errors.heading_error_rate


@compiled
def step(
    parameters: ControllerParameters,
    state: ControllerState,
    measurement: Measurement,
    request: Request,
    dt: Real,
) -> tuple[ControllerState, Assistance]:
    """One step of the paper's controller: `step_by` the heading-error rate."""
    return step_by(heading_error_rate, parameters, state, measurement, request, dt)
