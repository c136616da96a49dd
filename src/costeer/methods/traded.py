"""Traded control: authority by the size of the driver's torque, not its direction.

Trigger, paths and guidance are those of `ibhs`. What differs is who gives way: whoever
turns the wheel gets it, whether he helps or resists; who lets go hands it back.
"""

from __future__ import annotations

from functools import partial
from typing import NamedTuple

from costeer.base import array as xp
from costeer.base.array import Flag, Real, compiled
from costeer.controller import actuation, inference, replanning, trajectory
from costeer.controller import step as controller
from costeer.controller.actuation import ActuationParameters, ActuationState
from costeer.controller.guidance import GuidanceParameters
from costeer.controller.inference import InferenceParameters, InferenceState
from costeer.controller.preview import PreviewParameters
from costeer.controller.replanning import ReplanningParameters
from costeer.controller.signals import Assistance, Consistency, Request
from costeer.controller.trajectory import TrajectoryParameters, TrajectoryState
from costeer.methods.ibhs import like_ibhs, shared_tunables
from costeer.methods.interface import Method, Tunable
from costeer.plant.parameters import CarParameters, ColumnParameters, RoadParameters
from costeer.records.columns import Column
from costeer.sensing.measurement import Measurement


class AuthorityParameters(NamedTuple):
    """How authority changes hands.

    Attributes:
        holding_torque: A driver torque above it claims authority [N·m]. Source: as
            implemented in public, 0.1.
        steepness: Of the logistic function [1/s]. Source: as above, 3.
        midpoint: Both have half of it there [s]. Source: as above, 0.5.
        least: Least time of holding, from letting go long ago [s]. Source: as above,
            -0.5.
        most: Greatest time of holding [s]. Source: as above, 3.
    """

    holding_torque: Real = 0.1
    steepness: Real = 3.0
    midpoint: Real = 0.5
    least: Real = -0.5
    most: Real = 3.0


class TradedParameters(NamedTuple):
    """Guidance that gives way to any torque.

    Attributes:
        car: Nominal car [SI units]. Source: plant/parameters.py.
        column: Nominal column [SI units]. Source: plant/parameters.py.
        road: Lanes [SI units]. Source: plant/parameters.py.
        inference: Trigger and lock [SI units]. Source: Sec. II-B.
        trajectory: Duration of a lane change [SI units]. Source: Eq. (3).
        preview: Preview time [SI units]. Source: Fig. 4.
        guidance: Gains [SI units]. Source: Eq. (5).
        authority: How it changes hands [SI units]. Source: as implemented in public.
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
    authority: AuthorityParameters = AuthorityParameters()
    replanning: ReplanningParameters = ReplanningParameters()
    actuation: ActuationParameters = ActuationParameters()


class TradedState(NamedTuple):
    """What the method remembers.

    Attributes:
        inference: Trigger and lock.
        trajectory: Mode and plan.
        time_held: x, how long the driver has held the wheel, less how long not [s].
        replan: Whether the step before called for a new plan.
        actuation: Last torque.
    """

    inference: InferenceState
    trajectory: TrajectoryState
    time_held: Real
    replan: Flag
    actuation: ActuationState


@compiled
def initial_state(parameters: TradedParameters, lane: Real) -> TradedState:
    """Lane keeping in `lane`; all authority is the system's."""
    return TradedState(
        inference=inference.initial_state(),
        trajectory=trajectory.initial_state(parameters.road, lane),
        time_held=parameters.authority.least,
        replan=False,
        actuation=actuation.initial_state(),
    )


@compiled
def authority(parameters: AuthorityParameters, time_held: Real) -> Real:
    """The system's share of authority, 1 - logistic(3 (x - 0.5)) [-].

    Args:
        parameters: Steepness and midpoint.
        time_held: x [s].
    """
    beyond = parameters.steepness * (time_held - parameters.midpoint)
    return 1.0 - 1.0 / (1.0 + xp.exp(-beyond))


@compiled
def held(
    parameters: AuthorityParameters, time_held: Real, holds: Flag, dt: Real
) -> Real:
    """Time of holding, x, one step later [s]: up while the driver holds, else down.

    Args:
        parameters: Its limits.
        time_held: At the step before [s].
        holds: Whether the driver holds the wheel.
        dt: Control step [s].
    """
    moved = time_held + xp.select(holds, dt, -dt)
    return xp.clip(moved, parameters.least, parameters.most)


@compiled
def step(
    parameters: TradedParameters,
    state: TradedState,
    measurement: Measurement,
    request: Request,
    dt: Real,
) -> tuple[TradedState, Assistance]:
    """Guidance of `ibhs` at the authority that the driver leaves.

    Args:
        parameters: Of all stages.
        state: Of all stages.
        measurement: This step's sample.
        request: Verdict of the predictor and what is asked for from outside.
        dt: Control step [s].
    """
    trigger, intention, plan, target = controller.plan(
        parameters, state, measurement, request, True, dt
    )
    errors, torques = controller.instruct(parameters, target, measurement)
    driver = measurement.driver_torque
    holds = xp.absolute(driver) > parameters.authority.holding_torque
    time_held = held(parameters.authority, state.time_held, holds, dt)
    share = authority(parameters.authority, time_held)
    replan = replanning.replan(parameters.replanning, share, False)
    felt = actuation.felt_instruction(torques, driver)
    limited, torque = actuation.step(
        parameters.actuation, state.actuation, share, felt, dt
    )
    new_state = TradedState(
        inference=trigger,
        trajectory=plan,
        time_held=time_held,
        replan=replan,
        actuation=limited,
    )
    return new_state, Assistance(
        applied_torque=torque,
        haptic_gain=share,
        intention=intention.detected,
        target=target,
        preview=errors,
        guidance=torques,
        consistency=Consistency(consistent=xp.logical_not(holds)),
        replan=replan,
    )


METHOD = Method(
    name="traded",
    version="1",
    source="traded control by the size of the torque, as implemented in public",
    parameters=partial(like_ibhs, TradedParameters),
    initial_state=initial_state,
    step=step,
    columns=(
        Column(
            "method_time_held",
            "s",
            "float64",
            "time for which the driver has held the wheel, less that he has not",
            "method.time_held",
        ),
    ),
    tunables=(
        Tunable(
            "holding_torque",
            "authority.holding_torque",
            "N·m",
            0.0,
            2.0,
            "driver torque that claims authority",
        ),
        *shared_tunables(TradedParameters),
    ),
)
