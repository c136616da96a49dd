"""Triggers are true, early or false; crossings the driver meant are seen or missed."""

from __future__ import annotations

from math import isnan

import numpy as np
import pytest

from costeer.study.crossings import LEFT, RIGHT
from costeer.study.detection import (
    EARLY,
    FALSE,
    TRUE,
    Detection,
    count,
    detect,
    lead_time,
    num_missed,
)
from tests.records.mirror import mirrored
from tests.study.shapes import Columns, changes

# Crossings at 13 s to the right and 33 s to the left.
PLAN = [(10.0, 6.0, RIGHT), (30.0, 6.0, LEFT)]


def drive(*triggers: float, hold: float = 0.5, mode: str = "manual") -> Columns:
    columns = changes(PLAN)
    time = columns["time"]
    intention = np.zeros(time.size, dtype=bool)
    for instant in triggers:
        intention |= (time >= instant - 1e-9) & (time < instant + hold)
    return columns | {
        "intention": intention,
        "crossing_probability": np.where(intention, 0.9, 0.1),
        "mode": np.full(time.size, mode, dtype="<U13"),
    }


def decided(columns: Columns, *spans: tuple[float, float, int]) -> Columns:
    decision = np.zeros(columns["time"].size, dtype=np.int8)
    for start, end, direction in spans:
        inside = (columns["time"] >= start) & (columns["time"] <= end)
        decision[inside] = direction
    return columns | {"driver_intention": np.ma.MaskedArray(decision, mask=False)}


def judged(columns: Columns) -> Detection:
    found = detect(columns)
    assert isinstance(found, Detection)
    return found


def verdicts(columns: Columns) -> list[str]:
    return [trigger.verdict for trigger in judged(columns).triggers]


@pytest.mark.parametrize(
    ("instant", "verdict"),
    [
        (7.9, FALSE),
        (8.1, EARLY),
        (9.9, EARLY),
        (10.1, TRUE),
        (12.9, TRUE),
        # After the crossing the adjacent lane is the other one, 20 s away.
        (13.1, FALSE),
        (50.0, FALSE),
    ],
)
def test_a_trigger_is_judged_by_what_follows(instant: float, verdict: str) -> None:
    assert verdicts(drive(instant)) == [verdict]


def test_only_a_crossing_to_that_side_counts() -> None:
    # At 12.9 s the car is left of the line: only a crossing to the right is meant.
    (trigger,) = judged(drive(12.9)).triggers
    assert trigger.direction == RIGHT
    assert trigger.crossing_time == pytest.approx(13.0)


def test_triggers_within_a_second_are_one() -> None:
    columns = drive(10.5, 11.4, 12.3, hold=0.2)
    found = judged(columns)
    assert [trigger.time for trigger in found.triggers] == pytest.approx([10.5])
    # 2 s later is another one.
    assert len(judged(drive(10.5, 12.5, hold=0.2)).triggers) == 2


def test_lead_time_is_from_the_first_trigger() -> None:
    found = judged(drive(10.5, 12.5, hold=0.2))
    first, second = found.crossings
    assert lead_time(found, first.time) == pytest.approx(2.5)
    assert lead_time(found, second.time) == 0.0
    assert num_missed(found) == 1


def test_an_early_trigger_is_no_miss() -> None:
    found = judged(drive(9.0, 31.0))
    assert num_missed(found) == 0
    assert lead_time(found, found.crossings[0].time) == pytest.approx(4.0)
    assert (count(found, EARLY), count(found, TRUE), count(found, FALSE)) == (1, 1, 0)


def test_a_crossing_the_driver_did_not_mean_makes_no_trigger_true() -> None:
    columns = drive(10.5, 31.0, mode="lane_keeping")
    unwanted = decided(columns, (28.0, 37.0, LEFT))
    assert verdicts(unwanted) == [FALSE, TRUE]
    found = judged(unwanted)
    assert len(found.crossings) == 1
    assert num_missed(found) == 0
    assert isnan(lead_time(found, 13.0))


def test_a_trigger_before_the_decision_is_false() -> None:
    # The guidance crosses on a false trigger and the driver then agrees.
    columns = drive(10.5, mode="lane_keeping")
    assert verdicts(decided(columns, (11.0, 17.0, RIGHT))) == [FALSE]
    assert verdicts(decided(columns, (10.4, 17.0, RIGHT))) == [TRUE]


@pytest.mark.parametrize(
    ("before_end", "meant", "found"),
    [(4.9, True, []), (4.9, False, [FALSE]), (5.1, True, [FALSE]), (0.1, True, [])],
)
def test_what_the_end_of_the_record_cuts_off_is_not_judged(
    before_end: float, meant: bool, found: list[str]
) -> None:
    end = float(drive()["time"][-1])
    spans = [(end - 8.0, end, RIGHT)] if meant else []
    columns = decided(drive(end - before_end, hold=0.05), *spans)
    assert verdicts(columns) == found


def test_no_trigger_is_counted_while_a_path_is_followed() -> None:
    columns = drive(10.5, 14.5, mode="lane_keeping")
    columns = decided(columns, (8.0, 17.0, RIGHT))
    following = (columns["time"] >= 10.5) & (columns["time"] < 16.5)
    columns["mode"] = np.where(following, "lane_changing", "lane_keeping")
    assert verdicts(columns) == [TRUE]


def test_a_mirrored_drive_is_judged_the_same() -> None:
    columns = decided(drive(10.5, 31.0, 50.0), (8.0, 17.0, RIGHT), (28.0, 37.0, LEFT))
    other = mirrored(columns)
    here, there = judged(columns).triggers, judged(other).triggers
    assert [t.verdict for t in here] == [TRUE, TRUE, FALSE]
    assert [t.verdict for t in there] == [t.verdict for t in here]
    assert [t.direction for t in there] == [-t.direction for t in here]


def test_people_under_assistance_cannot_be_judged() -> None:
    columns = drive(10.5, mode="lane_keeping")
    unknown = np.ma.MaskedArray(np.zeros(columns["time"].size, np.int8), mask=True)
    reason = detect(columns | {"driver_intention": unknown})
    assert isinstance(reason, str)
    assert "driver_intention" in reason
    manual = columns | {"mode": np.full(columns["time"].size, "manual")}
    assert verdicts(manual | {"driver_intention": unknown}) == [TRUE]


def test_without_inference_there_is_nothing_to_judge() -> None:
    columns = drive()
    silent = columns | {"crossing_probability": np.full(columns["time"].size, np.nan)}
    assert detect(silent) == "the intention inference did not run"
    # Scripted triggers have no probability, and are judged.
    scripted = drive(10.5)
    del scripted["crossing_probability"]
    assert verdicts(scripted) == [TRUE]


def test_an_inference_that_stays_silent_misses_everything() -> None:
    found = judged(drive())
    assert found.triggers == ()
    assert num_missed(found) == 2


def test_missing_columns_are_named() -> None:
    assert detect(changes(PLAN)) == "needs the column intention, not recorded"


def test_a_trigger_is_judged_by_the_side_that_it_was_about() -> None:
    columns = drive(11.0, 31.0)
    usual = [trigger.direction for trigger in judged(columns).triggers]
    assert usual == [RIGHT, LEFT]
    rows = columns["time"].size
    told = columns | {"crossing_side": np.zeros(rows, np.int8)}
    assert judged(told) == judged(columns)  # older records do not tell it
    wrong = columns | {"crossing_side": np.full(rows, LEFT, np.int8)}
    assert [(t.direction, t.verdict) for t in judged(wrong).triggers] == [
        (LEFT, FALSE),
        (LEFT, TRUE),
    ]
