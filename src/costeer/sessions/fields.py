"""Columns of the tables of a session: name, unit, range and meaning, each once."""

from __future__ import annotations

from typing import NamedTuple

UTC = "ISO 8601 in UTC, as 2026-01-31T09:30:00.000Z"
STORE = "session.sqlite"


class Field(NamedTuple):
    """A column of a table, and a row of `codebook.csv`.

    Attributes:
        column: Its name.
        meaning: What it is.
        unit: SI, "-" if there is none.
        range: Values that it can have.
        source: Where it comes from.
    """

    column: str
    meaning: str
    unit: str = "-"
    range: str = "text"
    source: str = STORE


_WHO = Field("participant", "pseudonym", range="up to four letters and a number")
_SLOT = Field(
    "slot", "row of the balanced order; that of a dropout is given again", range="1 ..."
)
_STEP = Field("step", "id of the step within the participant's session")
_CONDITION = Field(
    "condition",
    "of the drive, or of the drive before; empty without one",
    range="Table IV",
)
_LABEL = Field(
    "label",
    "of the trial, or of the trial before: names it among all of the participant",
)
_ATTEMPT = Field("attempt", "number of the attempt at the step", range="1 ...")
_REASON = Field("reason", "why, in the experimenter's or costeer's words")
_MONOTONIC = Field(
    "monotonic",
    "clock of the computer that is never set; it begins anew at a restart",
    "s",
    "0 ...",
)
_INSTRUMENT = (
    Field("instrument", "name of the questionnaire"),
    Field("version", "of its items and scores"),
)
_ANSWERED = Field("answered_at", "when the answers were sent", range=UTC)

PARTICIPANTS_FILE = "participants.csv"
QUESTIONNAIRES_FILE = "questionnaires.csv"
SCORES_FILE = "scores.csv"
EVENTS_FILE = "events.csv"
ATTEMPTS_FILE = "attempts.csv"

FIELDS: dict[str, tuple[Field, ...]] = {
    PARTICIPANTS_FILE: (
        _WHO,
        _SLOT,
        Field(
            "plan_version", "of the plan that the participant began with", range="1 ..."
        ),
        Field("plan_hash", "of that plan, whatever its comments say"),
        Field("language", "of texts and questionnaires"),
        Field(
            "status",
            "where it stands",
            range="active, finished, stopped, declined or dropped",
        ),
        _REASON,
        Field("began_at", "when the participant first sat down", range=UTC),
        _MONOTONIC,
        Field("finished_at", "when the last step was over; empty before", range=UTC),
        Field("num_steps", "steps of the session", range="1 ..."),
        Field("num_steps_over", "steps finished or skipped", range="0 ..."),
        Field("num_trials", "trials that count, as in trials.csv", range="0 ..."),
    ),
    QUESTIONNAIRES_FILE: (
        _WHO,
        _SLOT,
        _CONDITION,
        _LABEL,
        _STEP,
        *_INSTRUMENT,
        Field("language", "in which it was asked"),
        Field("item", "name of the question"),
        Field("value", "the answer: number, name of the option chosen, or text"),
        _ANSWERED,
        _MONOTONIC,
    ),
    SCORES_FILE: (
        _WHO,
        _SLOT,
        _CONDITION,
        _LABEL,
        _STEP,
        *_INSTRUMENT,
        Field("score", "name of the score", source="instrument"),
        Field(
            "value",
            "the score; empty where an answer is missing or the instrument has changed",
            range="number",
            source="instrument",
        ),
        _ANSWERED,
    ),
    EVENTS_FILE: (
        Field("utc", "wall clock", range=f"{UTC}; empty if it is not known"),
        _MONOTONIC,
        _WHO,
        _STEP,
        Field(
            "kind",
            "what happened: began, note, excluded, checked, pause, clock jump, ...",
        ),
        Field("text", "in words"),
        Field("length", "of a pause, or how far a clock jumped", "s", "number"),
        Field(
            "trial_time",
            "of what happened in a drive; time stands still in a pause",
            "s",
            "0 ...",
            "markers of the record",
        ),
        Field("record", "file of the drive that it happened in"),
        Field("data", "more of it", range="JSON"),
    ),
    ATTEMPTS_FILE: (
        _WHO,
        _SLOT,
        _STEP,
        _ATTEMPT,
        Field("kind", "trial or practice", range="drive or practise"),
        _CONDITION,
        _LABEL,
        Field("scenario", "that was driven on, as the plan names it"),
        Field("order", "place among the trials; 0 for a practice", range="0 ..."),
        Field("state", "how it ended", range="finished, aborted or running"),
        Field(
            "excluded", "whether it is left out of the analysis", range="true or false"
        ),
        _REASON,
        Field("record", "file of the drive, within the folder of the study"),
        Field(
            "wheel_trace",
            "file of the wheel at 960 Hz, through every fade; may be none",
        ),
        Field("started_at", "when the attempt began", range=UTC),
        Field("ended_at", "when it was over; empty while it goes on", range=UTC),
        _MONOTONIC,
        Field("costeer", "version that drove"),
        Field("git_revision", "of its sources"),
        Field("input", "what was driven with", range="wheel, keys, stick"),
        Field("wheel", "model of the wheel; empty without one"),
        Field("wheel_calibration", "of the wheel, from its self-test", range="JSON"),
        Field("head", "kind of head tracker; empty without one"),
        Field("checks", "last check of the devices before it", range="JSON"),
        Field(
            "frame_rate",
            "pictures that the participant's page drew before it; empty if not told",
            "1/s",
            range="0 ...",
        ),
        Field("latency", "from device to page, as far as it was measured"),
    ),
}
