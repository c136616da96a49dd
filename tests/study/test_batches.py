"""A large study drives eight trials at a time, and nobody can tell."""

from __future__ import annotations

from pathlib import Path

import pytest

from costeer.loop.trial import simulate_trial
from costeer.study import batches
from costeer.study.batches import Work, named
from costeer.study.configuration import PUBLISHED_STUDY, trial_setup
from costeer.study.design import Trial
from costeer.study.run import ONE_MACHINE, run_study
from costeer.study.trials import likely_length

TRIALS = [Trial(k, "strong-normal", 1) for k in range(1, 20)]


def test_small_studies_are_done_trial_by_trial(monkeypatch: pytest.MonkeyPatch) -> None:
    work = Work(one=lambda trial: trial, several=list)
    assert [len(batch) for batch in work.batches(TRIALS)] == [1] * 19
    monkeypatch.setattr(batches, "TOGETHER_FROM", 19)
    assert [len(batch) for batch in work.batches(TRIALS)] == [8, 8, 3]
    alone = Work(one=lambda trial: trial)
    assert [len(batch) for batch in alone.batches(TRIALS)] == [1] * 19
    assert work.done(TRIALS[:2]) == alone.done(TRIALS[:2]) == TRIALS[:2]


def test_trials_that_last_as_long_are_driven_together(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(batches, "TOGETHER_FROM", 1)
    two_each = [Trial(who, name, 1) for who in range(1, 17) for name in ("a", "b")]
    work = Work(
        one=lambda trial: trial, several=list, lasting=lambda t: t.participant % 4
    )
    made = work.batches(two_each)
    assert [{t.participant % 4 for t in batch} for batch in made] == [
        {0},
        {1},
        {2},
        {3},
    ]
    assert sorted(t for batch in made for t in batch) == sorted(two_each)
    asked: list[Trial] = []
    Work(lambda t: t, list, lambda t: asked.append(t) or 0.0).batches(two_each)
    assert len(asked) == 16  # a driver's pace is the same in all conditions


def test_a_trial_likely_ends_within_its_likely_length() -> None:
    settings = PUBLISHED_STUDY._replace(length=2000.0)
    for who in range(1, 9):
        trial = Trial(who, "manual", 1)
        record = simulate_trial(trial_setup(settings, trial))
        rows = len(record.columns["time"])
        assert rows < likely_length(settings, trial) < 1.1 * rows
    broken = settings._replace(car="no such car")
    assert likely_length(broken, trial) == 0


def test_an_error_of_a_batch_names_where_it_is() -> None:
    assert named(TRIALS[:1]) == "participant 1, strong-normal: "
    assert (
        named(TRIALS[:8]) == "participant 1, strong-normal or one of 7 driven with it: "
    )


@pytest.mark.slow
@pytest.mark.parametrize("records", [True, False])
def test_tables_and_records_are_the_same_bytes(
    records: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    settings = PUBLISHED_STUDY._replace(
        participants=2,
        length=600.0,
        conditions=("manual", "strong-normal", "weak-rapid"),
    )
    scale = ONE_MACHINE._replace(records=records)
    run_study(tmp_path / "alone", settings, report=None, scale=scale)
    monkeypatch.setattr(batches, "TOGETHER_FROM", 2)
    told: list[object] = []
    run_study(
        tmp_path / "many", settings, report=None, scale=scale, progress=told.append
    )
    assert len(told) == 6
    files = {
        file.relative_to(tmp_path / "alone"): file.read_bytes()
        for file in (tmp_path / "alone").rglob("*")
        if file.is_file()
    }
    assert len(files) > 6
    for file, content in files.items():
        assert (tmp_path / "many" / file).read_bytes() == content, file
