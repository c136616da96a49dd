"""One trial of the study: simulated once, believed only if complete, measured."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any, NamedTuple

from costeer.intention.predictors.registry import PREDICTORS
from costeer.loop.scenario import TrialSetup, loop_parameters
from costeer.loop.together import simulate_together
from costeer.loop.trial import likely_steps
from costeer.methods.conditions import CONDITION_NAMES, MANUAL
from costeer.methods.registry import METHODS
from costeer.records.record import TrialRecord, read_record, write_record
from costeer.scale.worker import place
from costeer.study.configuration import StudySettings, trial_setup
from costeer.study.design import Trial, plan_trials
from costeer.study.folder import StudyFolder, record_path
from costeer.study.measures import (
    lane_change_rows,
    scenario_measure_rows,
    trial_row,
    trigger_rows,
)
from costeer.study.results import (
    TrialResult,
    description,
    read_result,
    remove_result,
    write_result,
)
from costeer.study.trial_tables import TrialRows

LENGTH_OF_TRY = 150.0
"""Of the drive that tries a plug-in: 4 s and more, a whole window of signals [m]."""

HASH_FIELD = "study_hash"
"""Metadata field of a record that binds it to the study's configuration."""

Simulate = Callable[[TrialSetup], TrialRecord]


class TrialDone(NamedTuple):
    """One trial that is measured, or has failed.

    Attributes:
        trial: Which one.
        rows: What the tables say of it; None if it failed, or a file of results has
            them.
        driver_seconds: Its length [s].
        resumed: Whether it was there before.
        failure: Why it failed; empty if it did not.
        about: What its record says of it, if there is no record to say it.
    """

    trial: Trial
    rows: TrialRows | None
    driver_seconds: float
    resumed: bool
    failure: str = ""
    about: Mapping[str, Any] | None = None  # as JSON gives it back


class OtherCodeError(ValueError):
    """A trial that was driven by other code than the study's."""


def study_trials(settings: StudySettings) -> list[Trial]:
    """Return all trials by participant and in the order of Table IV, as in tables."""
    places = {name: place for place, name in enumerate(CONDITION_NAMES)}
    trials = plan_trials(settings.participants, settings.conditions)
    return sorted(trials, key=lambda each: (each.participant, places[each.condition]))


def likely_length(settings: StudySettings, trial: Trial) -> int:
    """Control steps that a trial likely lasts; 0 of one that cannot be set up."""
    try:
        setup = trial_setup(settings, trial)
        return likely_steps(setup, loop_parameters(setup))
    except ValueError:
        return 0


def try_plug_ins(settings: StudySettings, simulate: Simulate) -> None:
    """Drive a few metres with what comes from outside costeer.

    What does not run is so refused before the study has a folder; what does run is
    compiled by then.

    Raises:
        ValueError: If it does not run.
    """
    chosen = (settings.method, METHODS), (settings.predictor, PREDICTORS)
    ours = all(isinstance(one, str) and one in known for one, known in chosen)
    first = next((c for c in settings.conditions if c != MANUAL), None)
    if ours or first is None:
        return
    setup = trial_setup(settings, Trial(1, first, 1))
    simulate(setup._replace(length=LENGTH_OF_TRY))


def finish_trial(
    folder: StudyFolder,
    settings: StudySettings,
    simulate: Simulate,
    trial: Trial,
    records: bool = True,
) -> TrialDone:
    """Make sure that the trial is measured, and its record on disk if it is wanted.

    Args:
        folder: Of the study.
        settings: Of the study.
        simulate: Called if there is no record to believe.
        trial: Which one.
        records: Whether its record is kept.

    Returns:
        Its measures, or why there are none.

    Raises:
        OSError: If the record cannot be written; nothing is left of it.
        OtherCodeError: If the code that is plugged in is not the study's.
    """
    there = resumed_trial(folder, trial)
    if there is not None:
        return there
    return _driven(folder, settings, simulate, trial, records)


def finish_together(
    folder: StudyFolder,
    settings: StudySettings,
    trials: Sequence[Trial],
    records: bool = True,
) -> list[TrialDone]:
    """`finish_trial` of several trials, which are driven together where they fit.

    Args:
        folder: Of the study.
        settings: Of the study.
        trials: Which ones.
        records: Whether their records are kept.

    Raises:
        OSError: As `finish_trial`.
        OtherCodeError: As `finish_trial`.
    """
    found = {trial: resumed_trial(folder, trial) for trial in trials}
    missing = [trial for trial, there in found.items() if there is None]
    made = simulate_together([trial_setup(settings, trial) for trial in missing])
    for trial, outcome in zip(missing, made, strict=True):
        given = partial(_given, outcome)
        found[trial] = _driven(folder, settings, given, trial, records)
    return [done for done in found.values() if done is not None]


def _given(outcome: TrialRecord | Exception, _: TrialSetup) -> TrialRecord:
    """What became of a trial: its record, or the error is raised."""
    if isinstance(outcome, Exception):
        raise outcome
    return outcome


def _driven(
    folder: StudyFolder,
    settings: StudySettings,
    simulate: Simulate,
    trial: Trial,
    records: bool,
) -> TrialDone:
    """Drive and measure a trial, see `finish_trial`."""
    try:
        made = simulate(trial_setup(settings, trial))
        _check_code(folder, made)
        record = made._replace(metadata={**made.metadata, HASH_FIELD: folder.hash})
        measured = _measured(trial, record, resumed=False)
    except (OSError, MemoryError, OtherCodeError):
        raise
    except Exception as error:  # of this trial alone; the study goes on
        return TrialDone(trial, None, 0.0, resumed=False, failure=_reason(error))
    if not records:
        return measured._replace(about=description(record))
    write_record(record_path(folder.path, trial.participant, trial.condition), record)
    remove_result(folder, trial)
    return measured


def _reason(error: Exception) -> str:
    """Why a trial failed, on one line."""
    words = " ".join(str(error).split())
    return (
        words if isinstance(error, ValueError) else f"{type(error).__name__}: {words}"
    )


def _check_code(folder: StudyFolder, made: TrialRecord) -> None:
    """Refuse a trial of an edited method or predictor, here or on a worker.

    Raises:
        OtherCodeError: Naming what was edited.
    """
    if made.metadata.get("condition") == MANUAL:
        return
    plugged_in = ("method_source_hash", "method"), ("intention_model_hash", "predictor")
    for name, words in plugged_in:
        wanted, found = folder.configuration.get(name), made.metadata.get(name)
        if None not in (wanted, found) and wanted != found:
            raise OtherCodeError(
                f"{place()} has another {words} than this study was begun with; give "
                "all workers the same files"
            )


def keep_result(folder: StudyFolder, done: TrialDone) -> TrialDone:
    """Keep what no record keeps, measures or a failure, in the folder's results.

    Returns:
        The trial without the rows that are kept, so that a thousand drivers need no
        more memory than ten.

    Raises:
        OSError: If it cannot be written.
    """
    if done.resumed or (done.about is None and not done.failure):
        return done
    result = TrialResult(done.rows, done.driver_seconds, done.about or {}, done.failure)
    write_result(folder, done.trial, result)
    return done._replace(rows=None, about=None)


def resumed_trial(folder: StudyFolder, trial: Trial) -> TrialDone | None:
    """Measure the trial's record on disk; None if there is none to believe."""
    record = believed_record(folder, trial)
    return None if record is None else _measured(trial, record, resumed=True)


def kept_trial(folder: StudyFolder, trial: Trial) -> TrialDone | None:
    """A trial that was measured without a record, or failed; None if there is none.

    Its rows stay in the file.
    """
    result = read_result(folder, trial)
    if result is None:
        return None
    return TrialDone(trial, None, result.driver_seconds, True, result.failure)


def rows_of(folder: StudyFolder, done: TrialDone) -> TrialRows | None:
    """The rows of a trial, read from the results if they are there; None if it failed.

    Raises:
        ValueError: If they were removed meanwhile.
    """
    if done.rows is not None or done.failure:
        return done.rows
    result = read_result(folder, done.trial)
    if result is None or result.rows is None:
        who = f"participant {done.trial.participant}, {done.trial.condition}"
        raise ValueError(f"the result of {who} is gone; run the same command again")
    return result.rows


def believed_record(folder: StudyFolder, trial: Trial) -> TrialRecord | None:
    """Return the trial's record if it is complete and of this configuration."""
    path = record_path(folder.path, trial.participant, trial.condition)
    try:
        record = read_record(path)
    except (ValueError, FileNotFoundError):
        return None
    about = record.metadata
    found = about.get(HASH_FIELD), about.get("participant"), about.get("condition")
    wanted = folder.hash, trial.participant, trial.condition
    return record if found == wanted else None


def _measured(trial: Trial, record: TrialRecord, resumed: bool) -> TrialDone:
    rows = TrialRows(
        measures=trial_row(record, trial.order),
        lane_changes=lane_change_rows(record),
        triggers=trigger_rows(record),
        scenario=scenario_measure_rows(record),
    )
    time = record.columns["time"]
    return TrialDone(trial, rows, float(time[-1] - time[0]), resumed)
