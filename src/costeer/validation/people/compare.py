"""All comparisons with people, and the spectra of drift beside each other."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from costeer.drivers.population import USUAL
from costeer.validation.people import brain4cars, gps, leeds, ngsim, torque
from costeer.validation.people.brain4cars import BACK, OUT, SHOULDER_ANGLE, Look
from costeer.validation.people.drift import (
    Drift,
    drift,
    following_windows,
    frequencies,
    highway_windows,
)
from costeer.validation.people.findings import RealComparison, Values
from costeer.validation.people.observe import Observations, gathered, shape_errors
from costeer.validation.people.onset import OnsetTest
from costeer.validation.people.ranges import QUANTITIES
from costeer.validation.people.shape import ChangeMeasures, mean_shape_rms, rms

_PERCENT = 100.0
_NOTHING = np.empty(0)

Sides = dict[str, Values]


class Spectra(NamedTuple):
    """Mean power spectra of lane position, shapes `(frequency,)`.

    Attributes:
        frequency: [Hz].
        highway: Of the instrumented car [m²/Hz]; empty if absent.
        following: Of the filmed vehicles [m²/Hz]; empty if absent.
        drivers: Of virtual drivers [m²/Hz]; empty without a window.
    """

    frequency: Values
    highway: Values
    following: Values
    drivers: Values


def compare_real(
    observations: list[Observations],
    onset: Sequence[OnsetTest],
    folder: Path | None,
    domain: str = USUAL.domain,
) -> list[RealComparison]:
    """Every quantity of people beside the same of virtual drivers.

    Args:
        observations: Of a manual trial each.
        onset: Corrections of a heading error, a driver each; may be empty.
        folder: With the recordings (`folder.data_folder`); None for none.
        domain: Of the virtual drivers.

    Raises:
        ValueError: If a set that is present cannot be read.
    """
    people = _people(folder)
    drivers = _drivers(observations, onset)
    return [
        RealComparison(
            **each._asdict(),
            people=people[each.name],
            drivers=drivers[each.name],
            elsewhere=each.domain not in ("", domain),
        )
        for each in QUANTITIES
    ]


def drift_spectra(observations: list[Observations], folder: Path | None) -> Spectra:
    """Mean spectra of lane position in 20 s windows.

    Args:
        observations: Of a manual trial each.
        folder: With the recordings; None for none.
    """
    densities = [each.drift.density for each in observations]
    return Spectra(
        frequency=frequencies(),
        highway=_mean_density([drift(highway_windows(folder)).density]),
        following=_mean_density([drift(following_windows(folder)).density]),
        drivers=_mean_density(densities),
    )


def _mean_density(densities: list[Values]) -> Values:
    """Mean over all windows; empty without any."""
    windows = [each for each in densities if len(each)]
    return np.concatenate(windows).mean(axis=0) if windows else _NOTHING


def _people(folder: Path | None) -> Sides:
    """Values of people by the names of the quantities."""
    glances = brain4cars.glances(folder)
    one, two = (leeds.corrections(folder, heading) for heading in leeds.HEADINGS)
    highway, following = (
        drift(windows)
        for windows in (highway_windows(folder), following_windows(folder))
    )
    return {
        **_of_changes(ngsim.lane_changes(folder)),
        "R6": gps.annotated_durations(folder),
        **_of_looks(*glances.before, glances.straight),
        "R14": one.onset,
        "R15": two.onset,
        "R16": one.peak,
        "R17": two.peak,
        **_of_drift(highway, following),
        "R24": torque.torque_levels(folder),
        "R25": torque.reversal_rates(folder),
    }


def _drivers(observations: list[Observations], onset: Sequence[OnsetTest]) -> Sides:
    """Values of virtual drivers by the names of the quantities."""
    changes = [change for each in observations for change in each.changes]
    out, back = (
        [look for each in observations for look in each.looks[side]]
        for side in (OUT, BACK)
    )
    kept = Drift(
        deviation=gathered(observations, lambda each: each.drift.deviation),
        correlation_time=gathered(
            observations, lambda each: each.drift.correlation_time
        ),
        fast=gathered(observations, lambda each: each.drift.fast),
        density=_NOTHING,
    )
    of_changes = _of_changes(changes)
    return {
        **of_changes,
        "R6": of_changes["R1"],
        **_of_looks(out, back, gathered(observations, lambda each: each.false_glances)),
        **_of_onset(onset),
        **_of_drift(kept, kept),
        "R24": gathered(observations, lambda each: each.torque),
        "R25": gathered(observations, lambda each: each.reversals),
    }


def _of_changes(changes: list[ChangeMeasures]) -> Sides:
    errors = shape_errors(changes)
    mean = [_PERCENT * mean_shape_rms(errors)] if changes else []
    return {
        "R1": np.array([change.duration for change in changes]),
        "R2": np.array([_PERCENT * rms(error) for error in errors]),
        "R3": np.array(mean),
        "R4": np.array([change.peak_speed for change in changes]),
        "R5": np.array([change.onset_to_peak for change in changes]),
    }


def _of_looks(out: list[Look], back: list[Look], straight: Values) -> Sides:
    return {
        "R7": _PERCENT * np.array([look.glanced for look in out]),
        "R8": _PERCENT * np.array([look.glanced for look in back]),
        "R9": _leads(out),
        "R10": _leads(back),
        "R11": _PERCENT * straight,
        "R12": _shoulder(out),
        "R13": _shoulder(back),
    }


def _leads(looks: list[Look]) -> Values:
    """Leads of those who glanced [s]."""
    return np.array([look.lead for look in looks if look.glanced > 0.0])


def _shoulder(looks: list[Look]) -> Values:
    """100 where the head turned as for a look over the shoulder, else 0 [%]."""
    return _PERCENT * np.array([float(look.peak >= SHOULDER_ANGLE) for look in looks])


def _of_onset(onset: Sequence[OnsetTest]) -> Sides:
    times = np.array([test.onset for test in onset]).reshape(-1, 2)
    peaks = np.degrees(np.array([test.peak for test in onset]).reshape(-1, 2))
    return {
        "R14": times[:, 0],
        "R15": times[:, 1],
        "R16": peaks[:, 0],
        "R17": peaks[:, 1],
    }


def _of_drift(highway: Drift, following: Drift) -> Sides:
    return {
        "R18": highway.deviation,
        "R19": following.deviation,
        "R20": highway.correlation_time,
        "R21": following.correlation_time,
        "R22": highway.fast,
        "R23": following.fast,
    }
