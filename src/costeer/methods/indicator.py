"""Lane changes that the driver's indicator asks for.

`indicator` begins a path as soon as the lever is set. `indicator-acsf` is the same rule
with the timing of UN R79 for an automatically commanded steering function of category
C: it waits for 3.0 s (3.0 to 5.0 s are allowed), and its path takes 5 s.
"""

from __future__ import annotations

from typing import NamedTuple

from costeer.base import array as xp
from costeer.base.array import Flag, Real, compiled
from costeer.controller import actuation, trajectory
from costeer.controller import step as controller
from costeer.controller.actuation import ActuationParameters, ActuationState
from costeer.controller.guidance import GuidanceParameters
from costeer.controller.preview import PreviewParameters
from costeer.controller.signals import (
    LANE_CHANGING,
    LANE_KEEPING,
    Assistance,
    Intention,
    Request,
)
from costeer.controller.trajectory import TrajectoryParameters, TrajectoryState
from costeer.methods.conditions import Condition
from costeer.methods.ibhs import like_ibhs, shared_tunables
from costeer.methods.interface import Method, Tunable
from costeer.methods.lanes import LaneParameters, change
from costeer.plant.parameters import CarParameters, ColumnParameters, RoadParameters
from costeer.plant.road import lane_exists
from costeer.records.columns import Column
from costeer.sensing.measurement import Measurement


class LeverParameters(NamedTuple):
    """What follows when the indicator is set.

    Attributes:
        delay: From there to the start of the path [s]. Source: assumed 0; 3.0 to 5.0
            in UN R79, ACSF category C.
    """

    delay: Real = 0.0


class IndicatorParameters(NamedTuple):
    """Lane keeping and paths that the indicator begins.

    Attributes:
        car: Nominal car [SI units]. Source: plant/parameters.py.
        column: Nominal column [SI units]. Source: plant/parameters.py.
        road: Lanes [SI units]. Source: plant/parameters.py.
        lever: Delay [SI units]. Source: UN R79 for ACSF category C.
        lanes: When the followed lane changes [SI units]. Source: methods/lanes.py.
        trajectory: Duration of a lane change [SI units]. Source: Eq. (3).
        preview: Preview time [SI units]. Source: Fig. 4.
        guidance: Gains [SI units]. Source: Eq. (5).
        actuation: Strength and limits [SI units]. Source: Eq. (6), Table IV.
    """

    car: CarParameters = CarParameters()
    column: ColumnParameters = ColumnParameters()
    road: RoadParameters = RoadParameters()
    lever: LeverParameters = LeverParameters()
    lanes: LaneParameters = LaneParameters()
    trajectory: TrajectoryParameters = TrajectoryParameters()
    preview: PreviewParameters = PreviewParameters()
    guidance: GuidanceParameters = GuidanceParameters()
    actuation: ActuationParameters = ActuationParameters()


class LeverState(NamedTuple):
    """What the indicator has asked for.

    Attributes:
        side: That is asked for, -1 right, 0 none, +1 left [-].
        time_asked: Since then [s].
        served: Whether a path has begun since.
        scripted: Whether a script asks and not the lever; it asks for a moment, and
            stands until it is served.
    """

    side: Real
    time_asked: Real
    served: Flag
    scripted: Flag


class IndicatorState(NamedTuple):
    """What the method remembers.

    Attributes:
        lever: What is asked for.
        trajectory: Mode and plan.
        actuation: Last torque.
    """

    lever: LeverState
    trajectory: TrajectoryState
    actuation: ActuationState


@compiled
def initial_state(parameters: IndicatorParameters, lane: Real) -> IndicatorState:
    """The lever is off; follow the lane that the car starts in."""
    return IndicatorState(
        lever=LeverState(side=0.0, time_asked=0.0, served=False, scripted=False),
        trajectory=trajectory.initial_state(parameters.road, lane),
        actuation=actuation.initial_state(),
    )


@compiled
def listen(
    state: LeverState,
    measurement: Measurement,
    request: Request,
    keeping: Flag,
    dt: Real,
) -> LeverState:
    """What is asked for now, and since when.

    Args:
        state: What was asked for at the step before.
        measurement: Side of the adjacent lane, for a script that names none.
        request: Lever and script.
        keeping: Whether no path runs; a script is not heard while one does.
        dt: Control step [s].
    """
    lever = (request.indicator == 1.0) | (request.indicator == -1.0)
    waits = state.scripted & xp.logical_not(state.served)
    begins = request.requested & keeping & xp.logical_not(waits)
    scripted = (begins | waits) & xp.logical_not(lever)
    script = xp.select(waits, state.side, measurement.side)
    side = xp.select(lever, request.indicator, xp.select(scripted, script, 0.0))
    same = (side == state.side) & xp.logical_not(begins & scripted)
    return LeverState(
        side=side,
        time_asked=xp.select(same, state.time_asked + dt, 0.0),
        served=same & state.served,
        scripted=scripted,
    )


@compiled
def intention_of(
    parameters: IndicatorParameters,
    state: LeverState,
    measurement: Measurement,
    keeping: Flag,
    dt: Real,
) -> Intention:
    """Whether a path begins: once for each time that it is asked for.

    Args:
        parameters: Delay and road.
        state: What is asked for.
        measurement: Lane that the car is in.
        keeping: Whether no path runs.
        dt: Control step [s].
    """
    due = state.time_asked >= parameters.lever.delay - dt / 2.0
    open_to = lane_exists(parameters.road, measurement.lane + state.side)
    waiting = (state.side != 0.0) & xp.logical_not(state.served)
    return Intention(detected=waiting & due & open_to & keeping, side=state.side)


@compiled
def step(
    parameters: IndicatorParameters,
    state: IndicatorState,
    measurement: Measurement,
    request: Request,
    dt: Real,
) -> tuple[IndicatorState, Assistance]:
    """Lane keeping, or a path that the indicator has asked for.

    Args:
        parameters: Delay, lanes, guidance, limits.
        state: What is asked for, plan and last torque.
        measurement: This step's sample.
        request: Indicator, or a script.
        dt: Control step [s].
    """
    keeping = state.trajectory.mode == LANE_KEEPING
    lever = listen(state.lever, measurement, request, keeping, dt)
    intention = intention_of(parameters, lever, measurement, keeping, dt)
    plan, target = change(parameters, state.trajectory, measurement, request, intention)
    errors, torques = controller.instruct(parameters, target, measurement)
    limited, torque = actuation.step(
        parameters.actuation, state.actuation, 1.0, torques.instructed_torque, dt
    )
    begun = keeping & (plan.mode == LANE_CHANGING)
    new_state = IndicatorState(
        lever=lever._replace(served=lever.served | begun),
        trajectory=plan,
        actuation=limited,
    )
    return new_state, Assistance(
        applied_torque=torque,
        intention=intention.detected,
        target=target,
        preview=errors,
        guidance=torques,
    )


def parameters(
    condition: Condition,
    car: CarParameters,
    column: ColumnParameters,
    road: RoadParameters,
) -> IndicatorParameters:
    """Guidance and duration as those of `ibhs`; the path begins at once."""
    made: IndicatorParameters = like_ibhs(
        IndicatorParameters, condition, car, column, road
    )
    return made


def acsf_parameters(
    condition: Condition,
    car: CarParameters,
    column: ColumnParameters,
    road: RoadParameters,
) -> IndicatorParameters:
    """3.0 s to wait and 5 s for the path, whatever the condition's duration is."""
    return parameters(condition, car, column, road)._replace(
        lever=LeverParameters(delay=3.0),
        trajectory=TrajectoryParameters(change_duration=5.0),
    )


def _delay(low: Real, high: Real) -> Tunable:
    return Tunable("delay", "lever.delay", "s", low, high, "indicator to path")


INDICATOR = Method(
    name="indicator",
    version="1",
    source="the driver's indicator begins the path",
    parameters=parameters,
    initial_state=initial_state,
    step=step,
    columns=(
        Column(
            "method_asked_side",
            "-",
            "float64",
            "side that the indicator asks for, -1 right, +1 left",
            "method.lever.side",
            stepped=True,
            mirrored="flipped",
        ),
    ),
    tunables=(_delay(0.0, 5.0), *shared_tunables(IndicatorParameters)),
)
ACSF = INDICATOR._replace(
    name="indicator-acsf",
    source="UN R79, ACSF category C: timing of a lane change by indicator",
    parameters=acsf_parameters,
    tunables=(_delay(3.0, 5.0), *shared_tunables(IndicatorParameters)),
)
