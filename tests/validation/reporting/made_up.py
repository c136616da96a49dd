"""Evidence of a validation report that nobody simulated: quick, and known."""

from __future__ import annotations

import math

import numpy as np

from costeer.validation.arms import FREQUENCIES, PUBLISHED, TASKS, ArmTest
from costeer.validation.departures import LaneHold, departures
from costeer.validation.drawn import drawn_drivers
from costeer.validation.drawn_figure import Drawn
from costeer.validation.manual import PLANNED_CHANGES, ManualDriving, Row
from costeer.validation.people.compare import Spectra
from costeer.validation.people.findings import RealComparison
from costeer.validation.reporting.evidence import Evidence
from costeer.validation.resistance import CHANGE_DURATIONS, SYSTEMS, Resistance
from costeer.validation.spread import target_spreads
from costeer.validation.stability import Stability

SEED = 4
TRIAL = {
    "sdlp": 0.2,
    "swrr": 6.0,
    "driver_torque_rms": 0.3,
    "false_glance_share": 0.15,
    "distance": 8000.0,
    "duration": 400.0,
    "num_lane_departures": 0.0,
}
CHANGE = {
    "duration": 5.0,
    "duration_by_speed": 5.5,
    "onset_to_crossing": 2.5,
    "peak_lateral_speed": 0.9,
    "peak_steering_angle": 0.1,
    "overshoot": 0.2,
    "glance": 0.85,
    "first_glance_lead": 3.0,
}
NOTHING = math.nan


def driving(num_drivers: int, chance: float = 0.0) -> ManualDriving:
    """Drivers who differ by 5 % from one to the next; `chance` is added to all."""
    trials, changes = [], []
    for driver in range(1, num_drivers + 1):
        size = 1.0 + 0.05 * (driver - num_drivers / 2.0) + chance
        key = {"participant": driver}
        trials.append(key | {name: size * value for name, value in TRIAL.items()})
        for place in range(PLANNED_CHANGES):
            own: Row = key | {"direction": -1 if place % 2 else 1}
            grown = size * (1.0 + 0.01 * place)
            changes.append(own | {name: grown * v for name, v in CHANGE.items()})
    return ManualDriving(trials, changes, PLANNED_CHANGES * num_drivers)


def people(there: bool = True) -> list[RealComparison]:
    """A median that is met, a share that is missed, one that is only reported."""
    some = np.linspace(4.0, 8.0, 9) if there else np.empty(0)
    shares = 100.0 * (np.arange(20) < 15) if there else np.empty(0)
    usual = RealComparison(
        name="R1",
        quantity="duration",
        unit="s",
        source="Films (ngsim_lc)",
        people=some,
        drivers=np.linspace(4.5, 7.5, 7),
        published=(4.2, 5.6, 7.7),
        low=5.0,
        high=6.3,
        statistic="median",
        reason="Dense traffic.",
    )
    return [usual, _share(usual, shares), _reported(usual)]


def _share(usual: RealComparison, shares: np.ndarray) -> RealComparison:
    """14 of 20 drivers glance, where 80 to 90 % should."""
    return usual._replace(
        name="R2",
        quantity="glances",
        unit="%",
        source="Heads (brain4cars_head)",
        people=shares,
        drivers=100.0 * (np.arange(20) < 14),
        published=(NOTHING, 84.0, NOTHING),
        low=80.0,
        high=90.0,
        statistic="share",
    )


def _reported(usual: RealComparison) -> RealComparison:
    """A quantity without a range, with one value of drivers."""
    return usual._replace(
        name="R3",
        quantity="torque",
        unit="N·m",
        source="A set that no figure knows",
        drivers=np.array([0.3]),
        published=(NOTHING, NOTHING, NOTHING),
        low=NOTHING,
        high=NOTHING,
    )


def arms() -> list[ArmTest]:
    """One driver in the middle of each range, one far above it."""
    found = []
    for task in TASKS:
        middle = np.sqrt(PUBLISHED[task].low * PUBLISHED[task].high)
        admittance = np.array([middle, 100.0 * middle]).astype(complex)
        found.append(ArmTest(task, FREQUENCIES, admittance))
    return found


def resistance() -> list[Resistance]:
    """Two drivers; nobody overrules in time who is not asked to."""
    return [
        Resistance(duration, system, *np.full((7, 2), 0.25))
        for duration in CHANGE_DURATIONS
        for system in SYSTEMS
    ]


def stability() -> Stability:
    """Four drivers, of whom the last swings and leaves the road."""
    return Stability(
        car="default",
        speed=70.0 / 3.6,
        damping_ratio=np.array([0.3, 0.4, 0.5, 0.01]),
        frequency=np.full(4, 2.0),
        largest_modulus=np.full(4, 0.99),
        settling_time=np.full(4, 3.0),
        swing_ratio=np.full(4, 0.1),
        hunting=np.full(4, 0.08),
        edge_margin=np.array([0.5, 0.4, 0.3, -2.0]),
    )


def evidence(num_drivers: int = 6, there: bool = True) -> Evidence:
    """All of it."""
    first, second = driving(num_drivers), driving(num_drivers, 0.01)
    held = LaneHold(0.2, 0.0, 0.1, 20.0, 0.0, 8000.0)
    density = np.array([0.1, 0.01, 0.001])
    return Evidence(
        drawn=Drawn(SEED, drawn_drivers(SEED, num_drivers, 70.0 / 3.6)),
        driving=first,
        again=second,
        spreads=target_spreads(first, second),
        departures=departures([held] * num_drivers),
        people=people(there),
        spectra=Spectra(np.array([0.05, 0.2, 1.0]), density, np.empty(0), density),
        num_onsets=num_drivers,
        arms=arms(),
        resistance=resistance(),
        stability=stability(),
    )


def bare() -> Evidence:
    """Only manual driving."""
    return evidence()._replace(
        departures=None,
        people=[],
        spectra=None,
        num_onsets=0,
        arms=[],
        resistance=[],
        stability=None,
    )
