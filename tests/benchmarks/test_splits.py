"""The paper's split by time beside one by driver: as much, and nobody twice."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from benchmarks.paper_split import table
from benchmarks.splits import (
    PAPER,
    PaperRecordings,
    compare_splits,
    cut,
    last_minutes,
    paper_recordings,
    paper_setups,
    split_by_driver_alike,
    split_by_time,
    time_blocks,
)
from benchmarks.splits import (
    test_places as drawn_places,
)
from costeer.training.dataset import Split
from costeer.training.evaluate import evaluate
from costeer.training.recordings import Recording, recording
from tests.training.synthetic import columns

SMALL = PAPER._replace(
    num_drivers=4, trials_per_driver=3, num_test_drivers=2, test_time=100.0, block=30.0
)
SEED = 1


def trial(driver: int, number: int) -> Recording:
    """About 75 s, another noise for each trial."""
    made = columns(10 * driver + number, num_changes=3)
    return recording(f"driver {driver}", f"drive {driver}-{number}", made)


def trials(drivers: range) -> list[Recording]:
    return [trial(d, n) for d in drivers for n in range(SMALL.trials_per_driver)]


MADE = PaperRecordings(drivers=trials(range(4)), substitutes=trials(range(4, 6)))
BY_TIME = split_by_time(SMALL, MADE, SEED)
BY_DRIVER = split_by_driver_alike(SMALL, MADE, SEED)


def drivers_of(part: list[Recording]) -> set[str]:
    return {one.driver for one in part}


def samples(part: list[Recording]) -> int:
    return sum(len(one.side) for one in part)


def test_by_time_the_judges_are_known_by_driver_they_are_not() -> None:
    tested = {f"driver {place}" for place in drawn_places(SMALL, SEED)}
    assert drivers_of(BY_TIME.test) == drivers_of(BY_DRIVER.test) == tested
    assert tested <= drivers_of(BY_TIME.training)
    others = drivers_of(BY_DRIVER.training) | drivers_of(BY_DRIVER.validation)
    assert not tested & others
    assert len(others) == 4


def test_both_judge_the_same_samples_and_learn_from_as_many() -> None:
    for one, other in zip(BY_TIME.test, BY_DRIVER.test, strict=True):
        np.testing.assert_array_equal(one.features, other.features)
    for part in ("training", "validation"):
        # Blocks are of nearly one length; there are as many in both.
        a, b = samples(getattr(BY_TIME, part)), samples(getattr(BY_DRIVER, part))
        assert a == pytest.approx(b, rel=0.05)


def test_no_sample_is_in_two_parts_and_none_is_lost() -> None:
    total = sum(samples(part) for part in BY_TIME)
    assert total == samples(MADE.drivers)
    rows = [row.tobytes() for part in BY_TIME for r in part for row in r.features]
    assert len(set(rows)) == len(rows)


def test_one_sixth_of_the_rest_validates_and_the_end_tests() -> None:
    rest = len(BY_TIME.training) + len(BY_TIME.validation)
    assert len(BY_TIME.validation) == round(rest / 6.0)
    assert samples(BY_TIME.test) == 2 * 6000
    last = trial(drawn_places(SMALL, SEED)[0], SMALL.trials_per_driver - 1)
    own = [r for r in BY_TIME.test if r.driver == last.driver]
    np.testing.assert_array_equal(own[-1].features[-1], last.features[-1])


def test_a_part_does_not_know_what_follows_its_cut() -> None:
    whole = trial(0, 0)
    crossing = int(np.flatnonzero(whole.crossing)[0])
    part = cut(whole, 0, crossing - 60)
    assert whole.labels.positive[crossing - 100]
    assert not part.labels.positive.any()
    assert not part.labels.known[-180:].any()
    assert part.labels.known[:-180].all()


def test_blocks_are_of_about_one_length_and_lose_nothing() -> None:
    blocks = time_blocks(trial(0, 0), 30.0)
    assert samples(blocks) == len(trial(0, 0).side)
    lengths = [len(b.side) for b in blocks]
    assert max(lengths) - min(lengths) <= 1


def test_who_drove_too_little_is_named() -> None:
    with pytest.raises(ValueError, match="give more trials"):
        last_minutes([trial(0, 0)], 1000.0)


def test_another_number_of_drivers_is_refused() -> None:
    with pytest.raises(ValueError, match="set num_drivers"):
        split_by_time(SMALL._replace(num_drivers=5), MADE, SEED)


def test_trials_of_one_driver_are_different_drives() -> None:
    setups = paper_setups(PAPER, SEED)
    assert len(setups) == 12 * 10
    assert len({(s.participant, s.condition) for s in setups}) == len(setups)
    assert len({s.participant for s in setups[:90]}) == 9
    assert not {s.participant for s in setups[:90]} & {
        s.participant for s in setups[90:]
    }
    substitute = drawn_places(PAPER, SEED)[0]
    assert [s.speed for s in setups[90:100]] == [
        s.speed for s in setups[10 * substitute : 10 * substitute + 10]
    ]


def test_the_table_has_a_column_for_each_split() -> None:
    def say(
        features: NDArray[np.float64], absent: tuple[str, ...]
    ) -> NDArray[np.float64]:
        return np.where(np.arange(len(features)) < 179, np.nan, 0.4)

    judged = {"hours_of_parts": dict.fromkeys(Split._fields, 1.5)}
    judged |= evaluate(say, BY_TIME.test)
    lines = table({"by time": judged, "by driver": judged})
    (accuracy,) = [line for line in lines if line.startswith("accuracy  ")]
    never = judged["samples"]["accuracy_of_never"]
    assert accuracy.split()[1:] == [f"{never:.3f}"] * 2
    assert lines[-1].split()[-1] == "0.948"


@pytest.mark.slow
def test_both_splits_are_trained_and_judged() -> None:
    tiny = SMALL._replace(hidden_size=2, num_steps=2)
    found = compare_splits(tiny, MADE, SEED)
    lines = table(found)
    assert "by time" in lines[0]
    assert "by driver" in lines[0]
    assert found["by time"]["num_samples"] == found["by driver"]["num_samples"]


@pytest.mark.slow
def test_simulated_trials_are_split() -> None:
    one = PAPER._replace(num_drivers=2, trials_per_driver=1, num_test_drivers=1)
    found = paper_recordings(one, SEED)
    assert len(found.drivers) == 2
    assert len(found.substitutes) == 1
