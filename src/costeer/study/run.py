"""The study from the first trial to the report: run, stop, resume.

Each trial is a job of its own: simulate, write the record, measure it. A trial whose
record is complete and of this configuration is not simulated again, so that an
interrupted study goes on where it stopped. Nothing depends on which job runs when.
"""

from __future__ import annotations

import errno
import shlex
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple, TypeVar

from costeer.loop.trial import simulate_trial
from costeer.study.configuration import (
    PUBLISHED_STUDY,
    StudySettings,
    check_count,
    check_settings,
    settings_of,
    study_configuration,
    with_files_read,
)
from costeer.study.design import Trial
from costeer.study.folder import (
    STUDY_FILE,
    StudyFolder,
    locked,
    opened_study,
    read_study,
    unusable,
)
from costeer.study.jobs import MOST_JOBS, JobsStoppedError, default_jobs, run_jobs
from costeer.study.trial_tables import write_trial_tables
from costeer.study.trials import (
    Simulate,
    TrialDone,
    finish_trial,
    resumed_trial,
    study_trials,
    try_plug_ins,
)

WriteReport = Callable[[Path], object]
Done = TypeVar("Done", bound="TrialDone | None")


class StudyOutcome(NamedTuple):
    """What a run of the study did.

    Attributes:
        folder: Where everything lies.
        num_trials: Of the study.
        num_resumed: Of them, not simulated again.
        driver_seconds: Simulated in this run [s].
    """

    folder: Path
    num_trials: int
    num_resumed: int
    driver_seconds: float


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
) -> StudyOutcome:
    """Run the experiment, or finish one that was begun in the folder.

    Args:
        out: Folder; `docs/study.md` says what it will hold.
        settings: What to run.
        jobs: Trials at the same time; as many as processors if None. The results do
            not depend on it.
        report: Writes tests, figures and report; None for tables only.
        progress: Called in this thread with each trial that is done.
        simulate: Makes the record of a trial.

    Raises:
        ValueError: If a setting is out of range, or the folder is another study's or
            in use.
        OSError: If a file cannot be written; finished trials are kept.
        StudyInterrupted: If the user stopped it; finished trials are kept.
    """
    settings = check_settings(settings)
    jobs = default_jobs() if jobs is None else jobs
    check_count("jobs", jobs, 1, MOST_JOBS)
    driven = with_files_read(settings)
    configuration = study_configuration(settings)
    try_plug_ins(driven, simulate)
    with opened_study(Path(out), configuration, study_command(settings)) as folder:
        work = partial(finish_trial, folder, driven, simulate)
        done = _all_done(folder, work, jobs, progress)
        _write_results(folder.path, done, report)
    return StudyOutcome(
        folder=folder.path,
        num_trials=len(done),
        num_resumed=sum(each.resumed for each in done),
        driver_seconds=sum(each.driver_seconds for each in done if not each.resumed),
    )


def remake_tables(path: Path, jobs: int | None = None) -> int:
    """Write the tables of measures again from the records on disk.

    Args:
        path: A study's folder, finished or not.
        jobs: Records measured at the same time; as many as processors if None.

    Returns:
        The number of trials that have a complete record.

    Raises:
        ValueError: If it is no study, in use, or no trial has a complete record.
        OSError: If a file cannot be read or written.
    """
    folder = read_study(path)
    with locked(path):
        work = partial(resumed_trial, folder)
        jobs = default_jobs() if jobs is None else jobs
        found = _all_done(folder, work, jobs, ignore)
        done = [each for each in found if each is not None]
        if not done:
            raise ValueError(
                f"no trial of the study in {path} has a complete record; the first "
                "lines of its study.yaml hold the command that makes them"
            )
        _write_results(path, done, None)
    return len(done)


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
    work: Callable[[Trial], Done],
    jobs: int,
    progress: Callable[[Done], None],
) -> list[Done]:
    trials = study_trials(settings_in(folder))
    try:
        return run_jobs(work, trials, jobs, progress)
    except JobsStoppedError as stop:
        failed = None if stop.failed is None else trials[stop.failed]
        kept = (
            f"{stop.num_done} of {len(trials)} trials are done and kept in "
            f"{folder.path}; run the same command again to go on from there"
        )
        raise _explained(stop.__cause__, failed, kept) from stop.__cause__


def _explained(
    cause: BaseException | None, failed: Trial | None, kept: str
) -> BaseException:
    """Return the error to raise: what went wrong, what is kept, how to go on."""
    if isinstance(cause, KeyboardInterrupt):
        return StudyInterrupted(kept)
    where = f"participant {failed.participant}, {failed.condition}: " if failed else ""
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


def _write_results(
    path: Path, done: Sequence[TrialDone], report: WriteReport | None
) -> None:
    try:
        write_trial_tables(path, [each.rows for each in done])
        if report is not None:
            report(path)
    except KeyboardInterrupt:
        raise StudyInterrupted(
            f"all {len(done)} trials are done and kept in {path}; run the same "
            "command again for what is missing"
        ) from None
