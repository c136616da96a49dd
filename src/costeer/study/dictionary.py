"""What the columns of a study's tables are: meaning, unit and range of each.

docs/measures.md says how each is measured. The tables of the statistics are explained
in study/outcome.py, from where `explained` takes the words.
"""

from __future__ import annotations

import re
from typing import NamedTuple

from costeer.study.agreement import AgreementRow
from costeer.study.outcome import DroppedRow, EffectRow, PairRow, SummaryRow
from costeer.study.people import EXCLUSIONS_FILE, Exclusion
from costeer.study.quantities import WORKLOAD
from costeer.study.scenario_measures import ScenarioRow
from costeer.study.trial_tables import (
    LANE_CHANGES_FILE,
    SCENARIO_FILE,
    TRIALS_FILE,
    TRIGGERS_FILE,
)


class Entry(NamedTuple):
    """A column.

    Attributes:
        column: Its name.
        meaning: What it is.
        unit: SI, "-" if there is none.
        range: Values that it can have.
    """

    column: str
    meaning: str
    unit: str = "-"
    range: str = "number"


_COUNT = ("-", "0, 1, ...")
_FROM_0 = "0 ..."
_FLAG = ("-", "true or false; empty if it is not known")

_WHICH = (
    Entry("participant", "pseudonym, or number of a virtual driver", range="text"),
    Entry("condition", "name of the condition", range="Table IV"),
    Entry("strength", "of the guidance", range="manual, strong, weak, or a factor"),
    Entry(
        "change_duration", "planned duration of a lane change", "s", "empty in manual"
    ),
)

_TRIALS = (
    *_WHICH,
    Entry("order", "place among the participant's trials", "-", "1, 2, ..."),
    Entry(
        "sdlp",
        "standard deviation of the lateral position in lane keeping",
        "m",
        _FROM_0,
    ),
    Entry("swrr", "steering wheel reversals of more than 3 deg", "1/min", _FROM_0),
    Entry(
        "driver_torque_rms", "root mean square of the driver's torque", "N·m", _FROM_0
    ),
    Entry("line_crossing_time_minimum", "smallest time to line crossing", "s", _FROM_0),
    Entry("line_crossing_time_median", "median time to line crossing", "s", _FROM_0),
    Entry("duration", "of the trial", "s", _FROM_0),
    Entry("distance", "driven along the road", "m", _FROM_0),
    Entry("mean_speed", "mean of the longitudinal velocity", "m/s", _FROM_0),
    Entry("num_events", "overtaking events met", *_COUNT),
    Entry("num_lane_changes", "lane changes completed", *_COUNT),
    Entry(
        "num_dropped_changes", "crossings of the line that make no lane change", *_COUNT
    ),
    Entry(
        "lane_keeping_duration", "sum of the stretches of lane keeping", "s", _FROM_0
    ),
    Entry("num_lane_departures", "a wheel over a line outside lane changes", *_COUNT),
    Entry("num_triggers", "triggers of the intention inference", *_COUNT),
    Entry("num_true_triggers", "with an intended crossing within 3 s", *_COUNT),
    Entry("num_early_triggers", "with one in 3 to 5 s", *_COUNT),
    Entry("num_false_triggers", "with none in 5 s", *_COUNT),
    Entry("num_missed", "intended crossings without a true or early trigger", *_COUNT),
    Entry("false_triggers_per_km", "over the distance driven", "1/km", _FROM_0),
    Entry("missed_per_km", "over the distance driven", "1/km", _FROM_0),
    Entry(
        "detection_lead_time",
        "mean, from first trigger to crossing; 0 if missed",
        "s",
        _FROM_0,
    ),
    Entry("num_inconsistencies", "of driver and guidance", *_COUNT),
    Entry(
        "inconsistency_duration", "mean time with an inconsistent verdict", "s", _FROM_0
    ),
    Entry(
        "inconsistency_gain_minimum", "least haptic gain in any of them", "-", "0 to 1"
    ),
    Entry("recovery_time", "mean, until the gain was back", "s", _FROM_0),
    Entry("verdict_flips", "mean changes of the verdict within one", "-", _FROM_0),
    Entry("frozen_time", "mean time with the gain half-way and constant", "s", _FROM_0),
    Entry(
        "dropped_changes", "crossings that make no lane change, and why", range="text"
    ),
    *(
        Entry(each.name, f"{each.title}; of people only", "-", "0 to 100")
        for each in WORKLOAD
    ),
)

_SERIES = (
    Entry(
        "label",
        "names the trial among all of the participant; of sessions only",
        range="text",
    ),
    Entry(
        "scenario",
        "that was driven on, as the plan names it; of sessions only",
        range="text",
    ),
    Entry(
        "occasion",
        "how often the condition was planned on the scenario so far; of sessions only",
        "-",
        "1, 2, ...",
    ),
)

_LANE_CHANGES = (
    *_WHICH,
    Entry("index", "number in the trial", "-", "1, 2, ..."),
    Entry("direction", "-1 to the right, +1 to the left", "-", "-1 or 1"),
    Entry("start_time", "last yaw within 0.5 deg before the crossing", "s", _FROM_0),
    Entry("crossing_time", "the centre of gravity crosses the line", "s", _FROM_0),
    Entry("end_time", "first yaw within 0.5 deg after it", "s", _FROM_0),
    Entry("duration", "from start to end", "s", _FROM_0),
    Entry(
        "overshoot",
        "distance from the new lane's centre at the first extremum",
        "m",
        _FROM_0,
    ),
    Entry(
        "steering_velocity_rms", "of the steering wheel, start to end", "rad/s", _FROM_0
    ),
    Entry(
        "peak_steering_angle", "largest to either side, start to end", "rad", _FROM_0
    ),
    Entry("assisted", "whether the mode was lane_changing at any time in it", *_FLAG),
    Entry(
        "duration_by_speed", "with more than 0.1 m/s towards the new lane", "s", _FROM_0
    ),
    Entry("onset_to_crossing", "the part of it before the crossing", "s", _FROM_0),
    Entry("peak_lateral_speed", "largest, start to end", "m/s", _FROM_0),
    Entry("duration_quarter_degree", "as duration, by a yaw of 0.25 deg", "s", _FROM_0),
    Entry("duration_one_degree", "as duration, by a yaw of 1 deg", "s", _FROM_0),
    Entry(
        "detection_lead_time", "first trigger to crossing; 0 if missed", "s", _FROM_0
    ),
    Entry("num_inconsistencies", "that began from start to end", *_COUNT),
    Entry(
        "settled_time",
        "first time after the crossing from which yaw stays within 0.3 deg for 2 s",
        "s",
        _FROM_0,
    ),
    Entry("duration_until_settled", "from start to settled_time", "s", _FROM_0),
)

_TRIGGERS = (
    *_WHICH,
    Entry("kind", "how it is judged", range="true, early, false or missed"),
    Entry("time", "of the trigger", "s", _FROM_0),
    Entry("direction", "-1 to the right, +1 to the left", "-", "-1 or 1"),
    Entry("crossing_time", "of the intended crossing", "s", _FROM_0),
    Entry("lead", "crossing less trigger; 0 if missed", "s", _FROM_0),
    Entry("start_time", "of the time that is looked at", "s", _FROM_0),
    Entry("end_time", "of it", "s", _FROM_0),
    Entry(
        "initial_deviation",
        "from the centre of the meant lane at the start",
        "m",
        _FROM_0,
    ),
    Entry("largest_deviation", "until the end", "m", _FROM_0),
    Entry("wheel_over_line", "whether a wheel was beyond a line of that lane", *_FLAG),
    Entry("left_lane", "whether the centre of gravity was", *_FLAG),
    Entry("overshoot", "of a crossing, as in lane_changes.csv", "m", _FROM_0),
    Entry("peak_driver_torque", "largest to either side", "N·m", _FROM_0),
    Entry("driver_torque_rms", "root mean square", "N·m", _FROM_0),
    Entry(
        "peak_opposing_torque", "largest guidance against the driver", "N·m", _FROM_0
    ),
    Entry(
        "gain_minimum", "least haptic gain, without the strength factor", "-", "0 to 1"
    ),
    Entry("inconsistent", "whether a verdict was inconsistent", *_FLAG),
    Entry("replanned", "whether the gain fell below the re-plan gain then", *_FLAG),
    Entry(
        "time_to_recover",
        "until the gain was back after the last such verdict",
        "s",
        _FROM_0,
    ),
    Entry(
        "time_to_settle", "until the car was settled in the meant lane", "s", _FROM_0
    ),
)

_DOCUMENTED = {
    "tests.csv": EffectRow,
    "pairs.csv": PairRow,
    "summaries.csv": SummaryRow,
    "dropped.csv": DroppedRow,
    "answers_tests.csv": EffectRow,
    "answers_pairs.csv": PairRow,
    "answers_summaries.csv": SummaryRow,
    "answers_dropped.csv": DroppedRow,
    "agreement.csv": AgreementRow,
    "again.csv": PairRow,
    EXCLUSIONS_FILE: Exclusion,
}

_UNIT = re.compile(r"\s*\[([^\]]+)\]")
_FIELD = re.compile(
    r"^ {8}(\w+): (.*?)(?=^ {8}\w|^ {4}\S|\Z)", re.MULTILINE | re.DOTALL
)


def tables() -> dict[str, tuple[Entry, ...]]:
    """Every table of a study by its file, with its columns in their order."""
    return {
        TRIALS_FILE: (
            *_TRIALS,
            *_SERIES,
            Entry(
                "ended_by",
                "what ended the drive; of sessions only",
                range="course, collision; empty if it is not known",
            ),
        ),
        LANE_CHANGES_FILE: (*_LANE_CHANGES, *_SERIES),
        TRIGGERS_FILE: (*_TRIGGERS, *_SERIES),
        SCENARIO_FILE: (*_WHICH, *explained(ScenarioRow), *_SERIES),
        **{file: explained(row) for file, row in _DOCUMENTED.items()},
    }


def explained(row: type[tuple[object, ...]]) -> tuple[Entry, ...]:
    """The columns of a table as the docstring of its row explains them."""
    said = {
        name: " ".join(words.split())
        for name, words in _FIELD.findall(row.__doc__ or "")
    }
    names: tuple[str, ...] = row._fields  # type: ignore[attr-defined]
    return tuple(_entry(name, said.get(name, "")) for name in names)


def _entry(name: str, words: str) -> Entry:
    """A column from its sentence; a unit stands in square brackets."""
    unit = _UNIT.search(words)
    meaning = _UNIT.sub("", words, count=1).rstrip(".")
    return Entry(name, meaning.replace("`", ""), unit[1] if unit else "-", "as it says")
