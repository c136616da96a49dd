"""What is left out: whole drivers, or blocks of one driver's time."""

from __future__ import annotations

import numpy as np
import pytest

from costeer.intention.features import full_windows
from costeer.training.left_out import (
    BLOCKS,
    DRIVERS,
    dealt,
    minutes,
    num_changes,
    parts,
)
from costeer.training.recordings import Recording, runs, wide_views
from tests.training.synthetic import columns, drive, drives


def rows(recordings: list[Recording]) -> int:
    return sum(len(each.side) for each in recordings)


def test_drivers_are_left_out_where_several_change_lanes() -> None:
    given = drives(3, num_changes=1)
    whole = parts(given)
    assert whole.kind == DRIVERS
    assert [one.name for one in whole.recordings] == [one.name for one in given]
    for training, judging in dealt(whole, 8, 1):
        assert len({each.driver for each in judging}) == 1
        assert not {r.driver for r in training} & {r.driver for r in judging}


def test_more_drivers_than_folds_are_left_out_in_groups() -> None:
    folds = dealt(parts(drives(5, num_changes=1)), 2, 1)
    judged = [{r.driver for r in judging} for _, judging in folds]
    assert len(judged) == 2
    assert not judged[0] & judged[1]
    assert len(judged[0] | judged[1]) == 5


def test_one_driver_is_cut_half_way_between_lane_changes() -> None:
    one = drive(1, num_changes=4)
    whole = parts([one])
    assert whole.kind == BLOCKS
    assert whole.names == ["block 1", "block 2", "block 3", "block 4"]
    assert [num_changes(each) for each in whole.recordings] == [1, 1, 1, 1]
    assert rows(whole.recordings) == len(one.side)
    crossed = np.flatnonzero(one.intended)
    assert len(whole.recordings[0].side) == (crossed[0] + crossed[1]) // 2


def test_no_window_lies_in_two_blocks() -> None:
    one = drive(1, num_changes=4)
    inside = sum(int(full_windows(r.features).sum()) for r in parts([one]).recordings)
    assert inside == len(one.side) - 4 * 179


def test_others_who_never_change_lanes_do_not_make_two_drivers() -> None:
    whole = parts([drive(1, num_changes=3), drive(2, num_changes=0)])
    assert whole.kind == BLOCKS
    assert len(whole.names) == 3


@pytest.mark.parametrize("lengths", ["as they are", "one cut short"])
def test_both_views_of_a_drive_are_in_the_same_block(lengths: str) -> None:
    views = [v for k in (1, 2) for v in wide_views(drive(k, num_changes=4))]
    views = [v._replace(driver="ann") for v in views]
    if lengths == "one cut short":
        views[0] = drive(1, num_changes=3)._replace(driver="ann", name=views[0].name)
    whole = parts(views)
    assert whole.kind == BLOCKS
    for start in (0, 2):
        names = {views[start].name, views[start + 1].name}
        pairs: dict[str, set[str]] = {}
        for each in whole.recordings:
            if each.name in names:
                pairs.setdefault(each.driver, set()).add(each.name)
        assert all(found == names for found in pairs.values())


def test_two_views_of_a_drive_are_driven_once() -> None:
    given = columns(1, num_changes=2)
    del given["distance_to_adjacent_lane"]
    given["crossing"] = np.diff(given.pop("lane"), prepend=1)
    views = runs("ann", "drive", given)
    assert len(views) == 2
    assert minutes(views) == pytest.approx((55.0 * 60.0 - 179.0) / 3600.0)
