"""The study from the first trial to the report: run, stop, resume.

Each trial is a task of its own: simulate, write the record, measure it. A trial whose
record is complete and of this configuration is not simulated again, so that an
interrupted study goes on where it stopped. Nothing depends on who does what when.
"""

from __future__ import annotations

import errno
import shlex
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

from costeer.loop.trial import simulate_trial
from costeer.scale.cluster import workers
from costeer.scale.jobs import JobsStoppedError, Pool, run_jobs
from costeer.scale.shard import WHOLE, Shard, part
from costeer.study.batches import Work, named
from costeer.study.configuration import (
    PUBLISHED_STUDY,
    StudySettings,
    check_settings,
    settings_of,
    study_configuration,
    with_files_read,
)
from costeer.study.design import Trial
from costeer.study.folder import (
    STUDY_FILE,
    StudyFolder,
    opened_study,
    read_study,
    remove_leftovers,
    unusable,
)
from costeer.study.locks import locked
from costeer.study.trial_tables import FailedRow, write_trial_tables
from costeer.study.trials import (
    Simulate,
    TrialDone,
    finish_together,
    finish_trial,
    keep_result,
    kept_trial,
    likely_length,
    resumed_trial,
    rows_of,
    study_trials,
    try_plug_ins,
)

WriteReport = Callable[[Path], object]


class Scale(NamedTuple):
    """Where the work is done and what is kept; no number in a table depends on it.

    Attributes:
        cluster: `local:N` or the address of a scheduler; empty for threads here.
        records: Whether the trials' records are kept, or their measures alone.
        shard: Part of the trials, for one job of many.
    """

    cluster: str = ""
    records: bool = True
    shard: Shard = WHOLE


ONE_MACHINE = Scale()


class StudyOutcome(NamedTuple):
    """What a run of the study did.

    Attributes:
        folder: Where everything lies.
        num_trials: Of the study, or of the shard.
        num_resumed: Of them, not simulated again.
        driver_seconds: Simulated in this run [s].
        failed: Trials without a result.
    """

    folder: Path
    num_trials: int
    num_resumed: int
    driver_seconds: float
    failed: tuple[FailedRow, ...] = ()


class StudyInterrupted(KeyboardInterrupt):
    """The user stopped the study; its text says how to go on."""


def ignore(_: object) -> None:
    """Show no progress."""


def full_report(folder: Path, tell: Callable[[str], None] = ignore) -> None:
    """Write tests, figures and `report.html` into the study's folder.

    Args:
        folder: Of the study.
        tell: Called with a few words before each step.
    """
    from costeer.study.report import write_report  # matplotlib takes a second

    write_report(folder, tell)


def run_study(
    out: Path | str,
    settings: StudySettings = PUBLISHED_STUDY,
    *,
    jobs: int | None = None,
    report: WriteReport | None = full_report,
    progress: Callable[[TrialDone], None] = ignore,
    simulate: Simulate = simulate_trial,
    scale: Scale = ONE_MACHINE,
) -> StudyOutcome:
    """Run the experiment, or finish one that was begun in the folder.

    Args:
        out: Folder; `docs/study.md` says what it will hold.
        settings: What to run.
        jobs: Trials at the same time; as many as processors if None. The results do
            not depend on it.
        report: Writes tests, figures and report; None for tables only. A shard writes
            neither: `merge_study` does when all are there.
        progress: Called in this thread with each trial that is done.
        simulate: Makes the record of a trial.
        scale: Cluster, shard, and whether records are kept.

    Returns:
        What was done; a trial that failed is named there and in `failures.csv`.

    Raises:
        ValueError: If a setting is out of range, the folder is another study's or in
            use, a worker has another costeer, or every trial failed.
        OSError: If a file cannot be written; finished trials are kept.
        StudyInterrupted: If the user stopped it; finished trials are kept.
    """
    settings = check_settings(settings)
    driven = with_files_read(settings)
    configuration = study_configuration(settings)
    command = study_command(settings)
    with workers(jobs, scale.cluster) as pool:
        try_plug_ins(driven, simulate)
        with opened_study(Path(out), configuration, command, scale.shard) as folder:
            one = partial(finish_trial, folder, driven, simulate, records=scale.records)
            several = partial(finish_together, folder, driven, records=scale.records)
            together = several if simulate is simulate_trial else None
            work = Work(one, together, partial(likely_length, driven))
            done = _finished(folder, work, pool, progress, scale)
            if scale.shard.total == 1:
                remove_leftovers(folder.path)  # of workers that were killed
                write_results(folder, done, report)
    return outcome_of(folder.path, done)


def outcome_of(path: Path, done: Sequence[TrialDone]) -> StudyOutcome:
    """What there is, in numbers."""
    return StudyOutcome(
        folder=path,
        num_trials=len(done),
        num_resumed=sum(each.resumed for each in done),
        driver_seconds=sum(each.driver_seconds for each in done if not each.resumed),
        failed=_failed(done),
    )


def _finished(
    folder: StudyFolder,
    work: Work,
    pool: Pool,
    progress: Callable[[TrialDone], None],
    scale: Scale,
) -> list[TrialDone]:
    """Do the trials of the shard that are not done; return all of them in order."""
    trials = part(study_trials(settings_in(folder)), scale.shard)
    there = {} if scale.records else _kept(folder, trials)
    for each in there.values():
        progress(each)
    waiting = [trial for trial in trials if trial not in there]
    new = _all_done(folder, work, waiting, pool, progress, len(there))
    found = there | {each.trial: each for each in new}
    return [found[trial] for trial in trials]


def _kept(folder: StudyFolder, trials: Sequence[Trial]) -> dict[Trial, TrialDone]:
    """Trials that were measured before; those that failed are tried again."""
    found = (kept_trial(folder, trial) for trial in trials)
    return {each.trial: each for each in found if each and not each.failure}


def _failed(done: Sequence[TrialDone]) -> tuple[FailedRow, ...]:
    return tuple(FailedRow(*each.trial, each.failure) for each in done if each.failure)


def remake_tables(path: Path, jobs: int | None = None) -> int:
    """Write the tables of measures again from the records and results on disk.

    Args:
        path: A study's folder, finished or not.
        jobs: Records measured at the same time; as many as processors if None.

    Returns:
        The number of trials that have a complete record or result.

    Raises:
        ValueError: If it is no study, in use, or no trial has one.
        OSError: If a file cannot be read or written.
    """
    folder = read_study(path)
    with locked(path):
        done = trials_on_disk(folder, jobs)
        if not any(not each.failure for each in done):
            raise ValueError(
                f"no trial of the study in {path} has a complete record; the first "
                "lines of its study.yaml hold the command that makes them"
            )
        write_results(folder, done, None)
    return sum(not each.failure for each in done)


def trials_on_disk(folder: StudyFolder, jobs: int | None = None) -> list[TrialDone]:
    """The trials of a study that have a record, a result or a failure, in order.

    Args:
        folder: Of the study.
        jobs: Records measured at the same time; as many as processors if None.
    """

    def found(trial: Trial) -> TrialDone | None:
        return resumed_trial(folder, trial) or kept_trial(folder, trial)

    trials = study_trials(settings_in(folder))
    with workers(jobs) as pool:
        done = run_jobs(found, trials, pool, ignore)
    return [each for each in done if each is not None]


def study_command(settings: StudySettings) -> str:
    """Return what runs this study; the folder is left to fill in.

    It is a command, or a call in Python if something was given as an object.
    """
    if _objects(settings):
        return (
            "costeer.study(FOLDER, ...) in Python, with the same arguments; "
            f"{', '.join(_objects(settings))} given as objects"
        )
    default = PUBLISHED_STUDY._asdict()
    words = ["costeer", "study", "--out", "FOLDER"]
    for name, value in settings._asdict().items():
        # Another scenario has a length and a speed of its own.
        elsewhere = (
            name in ("length", "speed") and settings.scenario != default["scenario"]
        )
        if value != default[name] or elsewhere:
            words += _option(name, value)
    return shlex.join(words)


def _objects(settings: StudySettings) -> list[str]:
    """What no command line can name, as `method pi-keeping`."""
    given = {
        name: getattr(settings, name)
        for name in ("method", "car", "predictor", "scenario")
    } | {f"driver {n}": each for n, each in enumerate(settings.drivers, 1)}
    return [
        f"{name} {getattr(part, 'name', '')}".rstrip()
        for name, part in given.items()
        if not isinstance(part, str)
    ]


def _option(name: str, value: Any) -> list[str]:  # Any: of a setting
    """A setting as words of the command line."""
    if name == "mistakes":
        return [word for each in value for word in ("--mistake", each)]
    if name == "drivers":
        return [word for file in value for word in ("--driver", file)]
    if name == "parameters":
        return [w for place, number in value for w in ("--set", f"{place}={number!r}")]
    return [f"--{name}", ",".join(value) if name == "conditions" else str(value)]


def settings_in(folder: StudyFolder) -> StudySettings:
    """The settings of a study in a folder.

    Raises:
        ValueError: If one is missing or out of range, naming the file.
    """
    try:
        return settings_of(folder.configuration)
    except ValueError as error:
        raise ValueError(unusable(folder.path / STUDY_FILE, str(error))) from error


def _all_done(
    folder: StudyFolder,
    work: Work,
    trials: Sequence[Trial],
    pool: Pool,
    progress: Callable[[TrialDone], None],
    num_there: int,
) -> list[TrialDone]:
    batches = work.batches(trials)
    num_done: list[int] = []

    def keep(_: Sequence[Trial], done: list[TrialDone]) -> list[TrialDone]:
        kept = [keep_result(folder, each) for each in done]
        num_done.append(len(kept))
        return kept

    def tell(done: list[TrialDone]) -> None:
        for each in done:
            progress(each)

    try:
        done = run_jobs(work.done, batches, pool, tell, keep)
    except JobsStoppedError as stop:
        failed = None if stop.failed is None else batches[stop.failed]
        kept = (
            f"{num_there + sum(num_done)} of {num_there + len(trials)} trials are done "
            f"and kept in {folder.path}; run the same command again to go on from there"
        )
        raise _explained(stop.__cause__, failed, kept) from stop.__cause__
    return [each for batch in done for each in batch]


def _explained(
    cause: BaseException | None, failed: Sequence[Trial] | None, kept: str
) -> BaseException:
    """Return the error to raise: what went wrong, what is kept, how to go on."""
    if isinstance(cause, KeyboardInterrupt):
        return StudyInterrupted(kept)
    where = named(failed) if failed else ""
    if isinstance(cause, OSError):
        space = "free some space; " if cause.errno in _FULL else ""
        return OSError(f"{where}{_reason(cause)}; {space}{kept}")
    if isinstance(cause, ValueError):
        return ValueError(f"{where}{cause}; {kept}")
    return cause or AssertionError("jobs stopped without a cause")


_FULL = (errno.ENOSPC, errno.EDQUOT)


def _reason(error: OSError) -> str:
    name = f" ({error.filename})" if error.filename else ""
    return f"{error.strerror or error}{name}"


def write_results(
    folder: StudyFolder, done: Sequence[TrialDone], report: WriteReport | None
) -> None:
    """Write the tables, rows read one trial after another, then the report.

    Raises:
        ValueError: If every trial failed.
    """
    failed = _failed(done)
    if len(failed) == len(done):
        raise ValueError(
            f"all {len(done)} trials failed, the first with: {failed[0].reason}"
        )
    rows = (rows_of(folder, each) for each in done)
    try:
        write_trial_tables(folder.path, (each for each in rows if each), failed)
        if report is not None:
            report(folder.path)
    except KeyboardInterrupt:
        raise StudyInterrupted(
            f"all {len(done)} trials are done and kept in {folder.path}; run the same "
            "command again for what is missing"
        ) from None
