"""Lane changes and lane keeping in a recording."""

from __future__ import annotations

import numpy as np
import pytest

from costeer.identification.recording import drive_of
from costeer.identification.stretches import (
    MARGIN_AFTER,
    MARGIN_BEFORE,
    UNFINISHED,
    apart_from,
    changes,
    completed,
    lane_keeping,
    stretches,
    total_time,
)
from costeer.study.segments import Segments, segment
from tests.identification.driving import cut, recorded
from tests.identification.test_direct import drive_with, quintic_drive

DT = 1.0 / 60.0


@pytest.mark.parametrize("participant", [1, 2, 3])
def test_completed_changes_are_those_of_the_measures(participant: int) -> None:
    record = recorded(participant)
    drive, segments = drive_of(record), segment(record.columns)
    assert isinstance(segments, Segments)
    found = completed(drive, changes(drive))
    assert [c.direction for c in found] == [c.direction for c in segments.changes]
    for mine, theirs in zip(found, segments.changes, strict=True):
        # Rows here, instants between rows there.
        assert mine.start * DT == pytest.approx(theirs.start_time, abs=1.01 * DT)
        assert mine.end * DT == pytest.approx(theirs.end_time, abs=1.01 * DT)


def test_lane_keeping_stays_away_from_changes_and_from_the_end() -> None:
    drive = drive_of(recorded(1))
    found = changes(drive)
    for rows in lane_keeping(drive, found):
        assert rows.stop <= len(drive.lane) - round(UNFINISHED / DT)
        for change in found:
            before = rows.stop <= change.start - round(MARGIN_BEFORE / DT)
            after = rows.start >= change.end + round(MARGIN_AFTER / DT)
            assert before or after


def test_a_stretch_keeps_one_lane() -> None:
    drive = drive_of(recorded(2))
    for rows in lane_keeping(drive, changes(drive)):
        assert np.unique(drive.lane[rows]).size == 1


def test_who_crosses_back_at_once_has_not_changed_lanes() -> None:
    drive = quintic_drive([2.0, 2.0], [100.0, 102.0])
    found = changes(drive)
    assert len(found) == 2
    assert completed(drive, found) == []
    apart = apart_from(drive, found, 1.0, 1.0)
    assert not apart[round(98.5 / DT) : round(103.5 / DT)].any()


def test_a_change_that_the_recording_cuts_is_not_completed() -> None:
    record = recorded(1)
    whole = changes(drive_of(record))
    begun = drive_of(cut(record, slice(whole[0].crossing - 60, 12_000)))
    assert (
        len(completed(begun, changes(begun)))
        == len([c for c in whole if c.end < 12_000]) - 1
    )
    ended = drive_of(cut(record, slice(0, whole[0].crossing + 30)))
    assert changes(ended)[0].end == len(ended.lane)
    assert completed(ended, changes(ended)) == []


def test_a_drift_over_the_line_is_no_lane_change() -> None:
    # 1.8 m over ten minutes: the yaw never passes half a degree.
    position = np.linspace(0.0, -1.8, 36_000)
    drive = drive_with(
        lateral_position=position, lane=np.where(position < -1.75, 0.0, 1.0)
    )
    assert len(changes(drive)) == 1
    assert completed(drive, changes(drive)) == []


def test_short_stretches_are_left_out_and_the_time_is_of_the_others() -> None:
    flags = np.array([1, 1, 0, 1, 1, 1, 0, 1], dtype=bool)
    found = stretches(flags, 2)
    assert found == [slice(0, 2), slice(3, 6)]
    assert total_time(drive_of(recorded(1)), found) == pytest.approx(5 * DT)
