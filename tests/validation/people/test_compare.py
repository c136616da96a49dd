"""All comparisons with people: names, ranges, and real recordings where present."""

from __future__ import annotations

import math
import os
from pathlib import Path

import numpy as np
import pytest
from scipy.stats import binomtest

from costeer.drivers.population import SIMULATOR, TRAFFIC
from costeer.validation.people.compare import compare_real, drift_spectra
from costeer.validation.people.findings import (
    SHARE,
    RealComparison,
    is_target,
    people_value,
    value,
)
from costeer.validation.people.folder import ENVIRONMENT, data_folder
from costeer.validation.people.observe import Observations, observe
from costeer.validation.people.onset import OnsetTest
from costeer.validation.people.ranges import QUANTITIES
from costeer.validation.targets import TARGETS
from tests.validation.people.test_observe import CHANGES, trial

HAS_DATA = pytest.mark.skipif(
    not os.environ.get(ENVIRONMENT), reason=f"{ENVIRONMENT} names no recordings"
)
ONSET = [
    OnsetTest(participant=1, onset=(0.4, 0.3), peak=(0.1, 0.2)),
    OnsetTest(participant=2, onset=(0.6, 0.5), peak=(0.3, 0.4)),
]
FROM_TARGETS = {"R1": "M4", "R4": "M9", "R5": "M10", "R7": "M11", "R8": "M11"}
FROM_QUARTILES = ("R9", "R10", "R14", "R15", "R16", "R17")


def seen() -> Observations:
    return observe(trial(((56.0, -0.7), (77.0, 0.3))), CHANGES)


def by_name(found: list[RealComparison]) -> dict[str, RealComparison]:
    return {each.name: each for each in found}


@pytest.fixture(scope="module")
def real() -> dict[str, RealComparison]:
    return by_name(compare_real([], [], data_folder()))


def test_names_count_from_r1() -> None:
    names = [each.name for each in QUANTITIES]
    assert names == [f"R{k}" for k in range(1, len(QUANTITIES) + 1)]


def test_every_range_is_one() -> None:
    wrong = [q.name for q in QUANTITIES if math.isnan(q.low) != math.isnan(q.high)]
    assert wrong == []
    assert [q.name for q in QUANTITIES if q.low >= q.high] == []


@pytest.mark.parametrize(("name", "target"), FROM_TARGETS.items())
def test_ranges_of_the_targets_are_theirs(name: str, target: str) -> None:
    ours = next(each for each in QUANTITIES if each.name == name)
    theirs = next(each for each in TARGETS[TRAFFIC] if each.name == target)
    assert (ours.low, ours.high) == (theirs.low, theirs.high)


def test_without_recordings_drivers_are_still_held_to_the_ranges() -> None:
    found = compare_real([seen()], ONSET, None)
    assert [each.name for each in found] == [each.name for each in QUANTITIES]
    assert all(each.people.size == 0 for each in found)
    assert all(each.drivers.size > 0 for each in found)


def test_lane_changes_of_ngsim_are_of_traffic_and_hold_for_it_alone() -> None:
    lane_changes = {q.name for q in QUANTITIES if "(ngsim_lc)" in q.source}
    assert lane_changes == {"R1", "R2", "R3", "R4", "R5"}
    for domain, elsewhere in ((SIMULATOR, lane_changes), (TRAFFIC, set())):
        found = compare_real([seen()], ONSET, None, domain)
        assert {each.name for each in found if each.elsewhere} == elsewhere
        held = {each.name for each in found if is_target(each)}
        assert held.isdisjoint(elsewhere)
        assert "R14" in held


def test_drivers_values_stand_under_their_names() -> None:
    found = by_name(compare_real([seen(), seen()], ONSET, None))
    values = {name: value(each) for name, each in found.items()}
    assert values["R7"] == 100.0
    assert (values["R12"], values["R13"]) == (100.0, 0.0)
    assert values["R11"] == 0.0
    assert values["R14"] == pytest.approx(0.5)
    assert values["R15"] == pytest.approx(0.4)
    assert values["R16"] == pytest.approx(math.degrees(0.2))
    assert values["R17"] == pytest.approx(math.degrees(0.3))
    assert values["R24"] == pytest.approx(0.3)
    assert values["R25"] == pytest.approx(30.0, abs=2.0)
    assert values["R3"] < 0.1
    assert found["R1"].drivers.size == 4
    assert np.array_equal(found["R1"].drivers, found["R6"].drivers)
    assert np.array_equal(found["R18"].drivers, found["R19"].drivers)


def test_without_drivers_there_is_no_value() -> None:
    assert all(math.isnan(value(each)) for each in compare_real([], [], None))


def test_spectra_of_drivers_stand_alone_without_recordings() -> None:
    spectra = drift_spectra([seen()], None)
    assert spectra.highway.size == spectra.following.size == 0
    assert spectra.drivers.shape == spectra.frequency.shape
    # The made-up driver oscillates at 0.3 Hz.
    assert spectra.frequency[np.argmax(spectra.drivers)] == pytest.approx(0.3)
    assert drift_spectra([], None).drivers.size == 0


@HAS_DATA
def test_every_quantity_has_people(real: dict[str, RealComparison]) -> None:
    assert [name for name, each in real.items() if not each.people.size] == []


@HAS_DATA
@pytest.mark.parametrize("name", FROM_QUARTILES)
def test_ranges_are_the_middle_half_of_people(
    real: dict[str, RealComparison], name: str
) -> None:
    quartiles = np.percentile(real[name].people, [25.0, 75.0])
    # The ranges are printed with two or three digits.
    assert (real[name].low, real[name].high) == pytest.approx(quartiles, rel=0.01)


@HAS_DATA
@pytest.mark.parametrize(("one", "other"), [("R18", "R19"), ("R20", "R21")])
def test_ranges_of_drift_span_both_sets(
    real: dict[str, RealComparison], one: str, other: str
) -> None:
    low = np.percentile(real[one].people, 25.0)
    high = np.percentile(real[other].people, 75.0)
    for name in (one, other):
        assert (real[name].low, real[name].high) == pytest.approx((low, high), rel=0.01)


@HAS_DATA
@pytest.mark.parametrize("name", ["R12", "R13"])
def test_ranges_of_shares_are_intervals_of_wilson(
    real: dict[str, RealComparison], name: str
) -> None:
    people = real[name].people
    count = int(np.count_nonzero(people))
    interval = binomtest(count, people.size).proportion_ci(0.95, "wilson")
    expected = (100.0 * interval.low, 100.0 * interval.high)
    assert (real[name].low, real[name].high) == pytest.approx(expected, abs=0.1)


@HAS_DATA
def test_people_do_as_was_published(real: dict[str, RealComparison]) -> None:
    for each in real.values():
        middle = each.published[1]
        if math.isnan(middle):
            continue
        # Half of the recordings are here; shares of 30 to 50 windows are 5 to 7 %
        # sure.
        tolerance = 8.0 if each.statistic == SHARE else 0.15 * middle
        assert people_value(each) == pytest.approx(middle, abs=tolerance), each.name


@HAS_DATA
@pytest.mark.parametrize("name", ["R1", "R2", "R3", "R4", "R5", "R7", "R8"])
def test_people_lie_in_the_ranges_of_the_targets(
    real: dict[str, RealComparison], name: str
) -> None:
    assert is_target(real[name])
    assert real[name].low <= people_value(real[name]) <= real[name].high


@HAS_DATA
def test_spectra_of_people_fall_with_frequency() -> None:
    spectra = drift_spectra([], data_folder(Path(os.environ[ENVIRONMENT])))
    for density in (spectra.highway, spectra.following):
        # 0.05, 0.45 and 1 Hz: at least as the square of the frequency.
        assert density[0] > 50.0 * density[8]
        assert density[8] > 5.0 * density[-1]
