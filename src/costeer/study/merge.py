"""Shards put together: every trial once, then tables and report."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import NamedTuple

from costeer.scale.gathered import copied, different, refuse_missing
from costeer.study.changes import refusal
from costeer.study.design import Trial
from costeer.study.folder import (
    StudyFolder,
    opened_study,
    read_study,
    record_path,
    result_path,
)
from costeer.study.locks import locked
from costeer.study.results import TrialResult, cells_of, read_result
from costeer.study.run import (
    StudyOutcome,
    WriteReport,
    full_report,
    outcome_of,
    settings_in,
    study_command,
    trials_on_disk,
    write_results,
)
from costeer.study.trials import believed_record, resumed_trial, study_trials


class Found(NamedTuple):
    """A trial in a folder.

    Attributes:
        folder: Which one.
        file: Its record, or its result.
        is_record: Which of both.
        failed: Whether it is a failure.
    """

    folder: StudyFolder
    file: Path
    is_record: bool
    failed: bool


class Merged(NamedTuple):
    """What a merge did.

    Attributes:
        outcome: Of the whole study.
        repeated: Trials that several folders had, with the same bytes.
    """

    outcome: StudyOutcome
    repeated: tuple[Trial, ...]


def merge_study(
    folders: Sequence[Path | str],
    out: Path | str | None = None,
    report: WriteReport | None = full_report,
) -> Merged:
    """Write tables and report of a study whose shards are done.

    Args:
        folders: The folder that the shards shared, or those of all of them.
        out: Where the study is put together; needed for several folders.
        report: Writes tests, figures and report; None for tables only.

    Returns:
        What is there, and what was there more than once.

    Raises:
        ValueError: If trials are missing, a folder is another study's or in use, or
            two have the same trial with different results; it names them.
        OSError: If a file cannot be read or written.
    """
    studies = [read_study(Path(each)) for each in folders]
    if not studies:
        raise ValueError("there is nothing to merge: give the folders of the shards")
    _refuse_others(studies)
    if out is None and len(studies) > 1:
        raise ValueError(
            f"{len(studies)} folders need one to be put together in; give --out DIR"
        )
    if out is None:
        with locked(studies[0].path):
            return Merged(_written(studies[0], report), ())
    return _gathered(studies, Path(out), report)


def _refuse_others(studies: Sequence[StudyFolder]) -> None:
    for other in studies[1:]:
        if other.hash != studies[0].hash:
            told = refusal(other.configuration, studies[0].configuration)
            raise ValueError(f"{other.path} holds {told} as {studies[0].path}")


def _gathered(
    studies: Sequence[StudyFolder], out: Path, report: WriteReport | None
) -> Merged:
    first = studies[0]
    command = study_command(settings_in(first))
    with ExitStack() as held:
        for each in studies:
            if each.path.resolve() != out.resolve():
                held.enter_context(locked(each.path))
        chosen, repeated = _chosen(studies)
        own = held.enter_context(opened_study(out, first.configuration, command))
        for trial, found in chosen.items():
            _copy(own, trial, found)
        return Merged(_written(own, report), repeated)


def _chosen(
    studies: Sequence[StudyFolder],
) -> tuple[dict[Trial, Found], tuple[Trial, ...]]:
    """Where each trial is taken from, and those that several folders have.

    Raises:
        ValueError: If one is missing, or has different results in two folders.
    """
    chosen: dict[Trial, Found] = {}
    repeated, missing = [], []
    trials = study_trials(settings_in(studies[0]))
    for trial in trials:
        places = [found for study in studies if (found := _found(study, trial))]
        done = [found for found in places if not found.failed]
        if not places:
            missing.append(trial)
            continue
        for other in done[1:]:
            _refuse_different(trial, done[0], other)
        if len(done) > 1:
            repeated.append(trial)
        records = [found for found in done if found.is_record]
        chosen[trial] = (records or done or places)[0]
    refuse_missing(list(map(told, missing)), len(trials), "trials")
    return chosen, tuple(repeated)


def _found(study: StudyFolder, trial: Trial) -> Found | None:
    if believed_record(study, trial) is not None:
        file = record_path(study.path, trial.participant, trial.condition)
        return Found(study, file, is_record=True, failed=False)
    result = read_result(study, trial)
    if result is None:
        return None
    file = result_path(study.path, trial.participant, trial.condition)
    return Found(study, file, is_record=False, failed=bool(result.failure))


def _refuse_different(trial: Trial, one: Found, other: Found) -> None:
    """Refuse two results of a trial that are not the same, byte for byte."""
    if one.is_record == other.is_record:
        same = one.file.read_bytes() == other.file.read_bytes()
    else:
        same = _measures(one, trial) == _measures(other, trial)
    if not same:
        raise ValueError(different(told(trial), one.folder.path, other.folder.path))


def _measures(found: Found, trial: Trial) -> str:
    """Hash of the cells of a trial's rows, from record or result."""
    if found.is_record:
        done = resumed_trial(found.folder, trial)
        rows = None if done is None else done.rows
    else:
        result: TrialResult | None = read_result(found.folder, trial)
        rows = None if result is None else result.rows
    return hashlib.sha256(json.dumps(cells_of(rows)).encode()).hexdigest()


def _copy(own: StudyFolder, trial: Trial, found: Found) -> None:
    place = record_path if found.is_record else result_path
    copied({place(own.path, trial.participant, trial.condition): found.file})


def _written(folder: StudyFolder, report: WriteReport | None) -> StudyOutcome:
    """Write tables and report of a study that has all its trials."""
    done = trials_on_disk(folder)
    there = {each.trial for each in done}
    trials = study_trials(settings_in(folder))
    missing = [told(each) for each in trials if each not in there]
    refuse_missing(missing, len(trials), "trials")
    write_results(folder, done, report)
    return outcome_of(folder.path, done)


def told(trial: Trial) -> str:
    """A trial in words."""
    return f"participant {trial.participant} {trial.condition}"
