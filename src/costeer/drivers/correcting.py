"""Planning anew: a driver whose car is off the own path gives that path up.

Steering is not one movement that is run to its end: evidence that something is wrong
gathers until the driver acts on it (Markkula, Boer, Romano and Merat 2018). Here it is
the distance from the own lane-change path, beyond what manual driving explains. The new
path begins where the car is, ends in the same lane, and keeps the driver's own pace.
"""

from __future__ import annotations

from typing import NamedTuple

from costeer.base import array as xp
from costeer.base.array import Flag, Real, compiled
from costeer.base.bezier import path_point
from costeer.drivers.decision import DecisionState
from costeer.drivers.evidence import gathered
from costeer.drivers.tracking import TrackingState
from costeer.sensing.measurement import Measurement


class CorrectingParameters(NamedTuple):
    """When a lane change is planned anew.

    Attributes:
        usual_error: e_0, distance from the own path that nobody minds [m]. Source:
            95 % quantile of manual lane changes of virtual drivers.
        evidence_rate: r, how fast evidence gathers at twice `usual_error`; 0: never
            [1/s]. Source: at most one manual lane change in twenty is planned anew.
        forgetting_time: τ of the evidence [s]. Source: assumed.
        pause: From one plan to the next at least [s]. Source: shortest intervals of
            corrections, about 1 s.
        shortest: Least duration of a new plan [s]. Source: assumed.
    """

    usual_error: Real = 0.28
    evidence_rate: Real = 1.2
    forgetting_time: Real = 1.0
    pause: Real = 1.0
    shortest: Real = 2.0


class CorrectingState(NamedTuple):
    """What the driver remembers of the plan.

    Attributes:
        evidence: A, that the plan is wrong; a new one at 1 [-].
        time_in_plan: Since it was made [s].
        way: That it was made for, to the new lane [m].
        duration: That it was made for [s].
        due: Whether a new plan is made at this step.
    """

    evidence: Real
    time_in_plan: Real
    way: Real
    duration: Real
    due: Flag


@compiled
def initial_state() -> CorrectingState:
    """No plan, no evidence."""
    return CorrectingState(
        evidence=0.0, time_in_plan=0.0, way=1.0, duration=6.0, due=False
    )


@compiled
def paced(parameters: CorrectingParameters, state: CorrectingState, way: Real) -> Real:
    """Duration of a path over the way that is left [s].

    The peak of the lateral acceleration of a quintic is proportional to way over
    duration squared; with the root of the way it stays the driver's own.

    Args:
        parameters: Shortest duration.
        state: Way and duration of the plan before.
        way: To the new lane's centre [m].
    """
    share = xp.clip(way / xp.maximum(state.way, 0.1), 0.0, 2.0)
    return xp.maximum(state.duration * xp.sqrt(share), parameters.shortest)


@compiled
def step(
    parameters: CorrectingParameters,
    state: CorrectingState,
    aimed: TrackingState,
    measurement: Measurement,
    decided: DecisionState,
    steered: Real,
    dt: Real,
) -> CorrectingState:
    """Judge the own plan for one step.

    Args:
        parameters: Of this driver.
        state: Of the plan.
        aimed: Own path and wander of the aim.
        measurement: Where the car is.
        decided: When a lane change starts, and how long it is to last.
        steered: Side that the driver steers to, 0 for none [-].
        dt: Control step [s].
    """
    here = path_point(aimed.path, measurement.longitudinal_position)
    wanted = here.lateral_position + aimed.wander
    error = measurement.lateral_position - wanted
    rate, usual = parameters.evidence_rate, parameters.usual_error
    rule = rate, usual, parameters.forgetting_time
    evidence = gathered(*rule, state.evidence, error, dt)
    time = state.time_in_plan + dt
    due = (steered != 0.0) & (evidence >= 1.0) & (time >= parameters.pause)
    due = due & xp.logical_not(decided.started)
    begins = decided.started | due
    way = xp.absolute(aimed.path.y5 - measurement.lateral_position)
    planned = xp.select(decided.started, decided.change_duration, state.duration)
    duration = xp.select(due, paced(parameters, state, way), planned)
    return CorrectingState(
        evidence=xp.select(begins | (steered == 0.0), 0.0, evidence),
        time_in_plan=xp.select(begins, 0.0, time),
        way=xp.select(begins, way, state.way),
        duration=duration,
        due=due,
    )
