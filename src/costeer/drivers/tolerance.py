"""Tolerance: what is good enough is left alone until evidence against it has gathered.

Drivers keep a lane by single corrections, not by pursuing its centre: they let go what
lies within a band (satisficing; Goodrich, Stirling and Boer 2000), and outside it
evidence gathers until they act (Markkula, Boer, Romano and Merat 2018). Until then the
hands rest where the wheel has been on the whole, as against a steady side wind; then,
over about one steering movement, they come to what is seen to be needed, and follow it
until the evidence is gone. In a lane change, and in an emergency, the eyes never leave
the path.
"""

from __future__ import annotations

from typing import NamedTuple

from costeer.base import array as xp
from costeer.base.array import Flag, Real, compiled
from costeer.base.filters import low_pass
from costeer.drivers.evidence import gathered


class ToleranceParameters(NamedTuple):
    """When an intended wheel angle is corrected.

    Attributes:
        band: b, difference of the angle that is seen to be needed from the intended
            one that is let go; 0: none is, the driver follows all the time [rad].
            Source: assumed, with τ calibrated on manual lane keeping.
        evidence_rate: r, how fast evidence gathers at twice the band [1/s]. Source:
            onset of corrections of 1 deg, 0.40 s (Goodridge et al. 2022).
        forgetting_time: τ of the evidence [s]. Source: assumed, as the band.
        movement_time: Within it a correction is made up to a twentieth [s]. Source:
            Benderius and Markkula (2014), about 0.4 s of a single steering movement.
        trim_time: Over which resting hands know where the wheel has been [s]. Source:
            assumed.
    """

    band: Real = 0.006
    evidence_rate: Real = 0.22
    forgetting_time: Real = 5.0
    movement_time: Real = 0.4
    trim_time: Real = 20.0


class ToleranceState(NamedTuple):
    """What is let go.

    Attributes:
        intended: Steering-wheel angle that the hands go to [rad].
        offset: Of it from what is seen to be needed [rad].
        evidence: A, that it must be corrected, 0 to 1 [-].
        attends: Whether the hands follow the eyes.
        trim: Where resting hands go to [rad].
    """

    intended: Real
    offset: Real
    evidence: Real
    attends: Flag
    trim: Real


@compiled
def initial_state() -> ToleranceState:
    """Straight ahead, nothing to correct."""
    return ToleranceState(
        intended=0.0, offset=0.0, evidence=0.0, attends=False, trim=0.0
    )


@compiled
def step(
    parameters: ToleranceParameters,
    state: ToleranceState,
    asked: Real,
    watches: Flag,
    dt: Real,
) -> ToleranceState:
    """Let the hands rest or follow for one step.

    Args:
        parameters: Of this driver.
        state: Of this driver.
        asked: Steering-wheel angle that is seen to be needed [rad].
        watches: Whether the path needs the eyes all the time.
        dt: Control step [s].
    """
    always = watches | (parameters.band <= 0.0)
    trim = low_pass(state.trim, asked, dt, parameters.trim_time)
    lag = parameters.movement_time / 3.0
    resting = low_pass(state.intended, trim, dt, lag)
    missing = resting - asked
    rule = parameters.evidence_rate, parameters.band, parameters.forgetting_time
    beyond = xp.minimum(gathered(*rule, state.evidence, missing, dt), 1.0)
    evidence = xp.select(always, 1.0, beyond)
    attends = (evidence >= 1.0) | (state.attends & (evidence > 0.0))
    kept = low_pass(state.offset, 0.0, dt, lag)
    offset = xp.select(attends, kept, missing)
    return ToleranceState(
        intended=xp.select(attends, asked + kept, resting),
        offset=offset,
        evidence=evidence,
        attends=attends,
        trim=trim,
    )
