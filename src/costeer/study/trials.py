"""One trial of the study: simulated once, believed only if complete, measured."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from costeer.intention.predictors.registry import PREDICTORS
from costeer.loop.scenario import TrialSetup
from costeer.methods.conditions import CONDITION_NAMES, MANUAL
from costeer.methods.registry import METHODS
from costeer.records.record import TrialRecord, read_record, write_record
from costeer.study.configuration import StudySettings, trial_setup
from costeer.study.design import Trial, plan_trials
from costeer.study.folder import StudyFolder, record_path
from costeer.study.measures import (
    lane_change_rows,
    scenario_measure_rows,
    trial_row,
    trigger_rows,
)
from costeer.study.trial_tables import TrialRows

LENGTH_OF_TRY = 150.0
"""Of the drive that tries a plug-in: 4 s and more, a whole window of signals [m]."""

HASH_FIELD = "study_hash"
"""Metadata field of a record that binds it to the study's configuration."""

Simulate = Callable[[TrialSetup], TrialRecord]


class TrialDone(NamedTuple):
    """One trial that is on disk and measured.

    Attributes:
        rows: What the tables say of it.
        driver_seconds: Its length [s].
        resumed: Whether its record was there before.
    """

    rows: TrialRows
    driver_seconds: float
    resumed: bool


def study_trials(settings: StudySettings) -> list[Trial]:
    """Return all trials by participant and in the order of Table IV, as in tables."""
    places = {name: place for place, name in enumerate(CONDITION_NAMES)}
    trials = plan_trials(settings.participants, settings.conditions)
    return sorted(trials, key=lambda each: (each.participant, places[each.condition]))


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
    folder: StudyFolder, settings: StudySettings, simulate: Simulate, trial: Trial
) -> TrialDone:
    """Make sure that the trial's record is on disk, and measure it.

    Args:
        folder: Of the study.
        settings: Of the study.
        simulate: Called if there is no record to believe.
        trial: Which one.

    Raises:
        OSError: If the record cannot be written; nothing is left of it.
    """
    there = resumed_trial(folder, trial)
    if there is not None:
        return there
    made = simulate(trial_setup(settings, trial))
    record = made._replace(metadata={**made.metadata, HASH_FIELD: folder.hash})
    write_record(record_path(folder.path, trial.participant, trial.condition), record)
    return _measured(trial, record, resumed=False)


def resumed_trial(folder: StudyFolder, trial: Trial) -> TrialDone | None:
    """Measure the trial's record on disk; None if there is none to believe."""
    record = believed_record(folder, trial)
    return None if record is None else _measured(trial, record, resumed=True)


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
    return TrialDone(rows, float(time[-1] - time[0]), resumed)
