"""Trials that are driven eight at a time are those that are driven alone."""

from __future__ import annotations

import inspect
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from costeer.loop import lanes, together, trial
from costeer.loop.parameters import Bare, LoopParameters, without
from costeer.loop.scenario import TrialSetup, loop_parameters
from costeer.loop.together import simulate_together
from costeer.loop.trial import simulate_trial
from costeer.records.record import TrialRecord, write_record
from costeer.scenarios.definition import Stream
from costeer.scenarios.reading import scenario_named

LENGTH = 700.0


THREE_LANES = scenario_named("three-lanes")._replace(stream=Stream(), actors=())


def setup(
    participant: int, condition: str = "strong-normal", **others: Any
) -> TrialSetup:
    given = {"seed": 11, "length": LENGTH, "condition": condition} | others
    return TrialSetup(participant=participant, **given)


def bytes_of(record: object, folder: Path) -> bytes:
    assert isinstance(record, TrialRecord), record
    write_record(folder / "one.arrow", record)
    return (folder / "one.arrow").read_bytes()


def driven_both_ways(setups: Any, folder: Path, monkeypatch: pytest.MonkeyPatch) -> Any:
    """Bytes of the records, together and alone, and the blocks that were driven."""
    blocks = []
    run = together._run
    monkeypatch.setattr(
        together,
        "_run",
        lambda trials, steps: blocks.append(trials) or run(trials, steps),
    )
    found = [bytes_of(each, folder) for each in simulate_together(setups)]
    alone = [bytes_of(simulate_trial(each), folder) for each in setups]
    return found, alone, blocks


@pytest.mark.slow
def test_records_are_the_same_bytes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    setups = [
        *(
            setup(k, c)
            for k in (1, 2)
            for c in ("manual", "strong-rapid", "weak-gentle")
        ),
        *(setup(k, driver="virtual-2") for k in (3, 4, 5, 8, 9)),
        setup(6, method="traded"),
        setup(7, mistakes=("latency=0.05",)),
    ]
    found, alone, blocks = driven_both_ways(setups, tmp_path, monkeypatch)
    assert found == alone
    assert len(blocks) == 2  # of eleven that fit; two are driven alone


@pytest.mark.slow
@pytest.mark.parametrize(
    "others",
    [
        {"scenario": "expressway-curves"},
        {"scenario": THREE_LANES},
        {"scenario": "crosswind"},
        {"intention": "scripted"},
        {"intention": "off", "trigger_times": (4.0, 12.0)},
        {"exact_network": True, "length": 300.0},
    ],
    ids=["curves", "three-lanes", "wind", "scripted", "requested", "exact"],
)
def test_records_are_the_same_bytes_elsewhere(
    others: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    setups = [setup(participant, **others) for participant in (1, 2, 3)]
    found, alone, blocks = driven_both_ways(setups, tmp_path, monkeypatch)
    assert found == alone
    assert len(blocks) == 1


@pytest.mark.slow
def test_a_trial_that_cannot_be_driven_spoils_no_other(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def broken(setup: TrialSetup, rows: Any) -> None:
        if setup.participant == 2:
            raise ValueError("the car has left the numbers")

    monkeypatch.setattr(trial, "_refuse_broken", broken)
    setups = [setup(k) for k in (1, 2, 3, 4)]
    setups[2] = setups[2]._replace(length=-3.0)
    first, gone, refused, last = simulate_together(setups)
    assert "left the numbers" in str(gone)
    assert isinstance(refused, ValueError)
    assert "length" in str(refused)
    for record, own in ((first, setups[0]), (last, setups[3])):
        assert bytes_of(record, tmp_path) == bytes_of(simulate_trial(own), tmp_path)


@pytest.mark.slow
def test_who_is_slow_gets_random_numbers_until_the_end(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(trial, "LIKELY_SHARE", 1.4)
    setups = [setup(participant) for participant in (1, 2, 3)]
    found, alone, blocks = driven_both_ways(setups, tmp_path, monkeypatch)
    assert found == alone
    assert len(blocks) == 2  # the first one ran out


@pytest.mark.slow
def test_a_trial_ends_when_its_own_time_is_over(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    crawls = (("driver.longitudinal.preferred_speed", 8.0),)
    setups = [
        setup(participant)._replace(speed=speed, parameters=crawls, events=False)
        for participant, speed in ((1, 12.0), (2, 12.0), (3, 30.0))
    ]
    found, alone, _ = driven_both_ways(setups, tmp_path, monkeypatch)
    assert found == alone


def test_every_parameter_reaches_the_trials_of_a_block() -> None:
    bare = Bare(fleet=True, mistakes=True)
    given = without(loop_parameters(setup(1)), bare)
    each = lanes.own(given)
    assert lanes.joined(each, given) == given
    taken = inspect.signature(LoopParameters).parameters
    assert set(lanes.SHARED) < set(taken)
    other = given._replace(**dict.fromkeys(lanes.SHARED, 0.0))
    assert all(getattr(lanes.joined(each, other), name) == 0.0 for name in lanes.SHARED)


def test_few_trials_are_driven_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(together, "_run", None)
    monkeypatch.setattr(together, "simulate_trial", lambda given: given.participant)
    assert simulate_together([setup(4), setup(2)]) == [4, 2]


def test_without_cars_and_mistakes_a_trial_is_the_same(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    given = setup(1, length=400.0)
    lean = simulate_trial(given)
    nothing_left_out = Bare(fleet=False, mistakes=False)
    monkeypatch.setattr("costeer.loop.rollout.bare_of", lambda _: nothing_left_out)
    whole = simulate_trial(given)
    assert lean.columns.keys() == whole.columns.keys()
    for name, column in lean.columns.items():
        np.testing.assert_array_equal(column, whole.columns[name], err_msg=name)
