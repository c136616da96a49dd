"""The figures of docs/paper.md show what the code is."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import matplotlib.colors

from benchmarks.paper_figures import (
    ARROWS,
    BOXES,
    HIGH,
    ORDERS,
    WIDE,
    is_light,
    sessions,
    word_of,
)
from costeer import controller
from costeer.methods.conditions import CONDITION_NAMES


def test_every_stage_of_the_controller_is_a_block_once() -> None:
    folder = Path(controller.__file__).parent
    helpers = {"__init__", "signals", "step", "hands", "realtime"}
    stages = {path.stem for path in folder.glob("*.py")} - helpers
    drawn = [box.module for box in BOXES if box.module]
    assert sorted(drawn) == sorted(stages)


def test_arrows_begin_and_end_at_blocks_and_run_level_or_upright() -> None:
    edges = {
        (round(x + a, 6), round(y + b, 6))
        for x, y in (box.place for box in BOXES)
        for a, b in ((WIDE, 0), (-WIDE, 0), (0, HIGH), (0, -HIGH))
    }
    for arrow in ARROWS:
        for end in (arrow.points[0], arrow.points[-1]):
            assert (round(end[0], 6), round(end[1], 6)) in edges
        for (x, y), (to_x, to_y) in pairwise(arrow.points):
            assert (x == to_x) != (y == to_y)


def test_the_session_drawn_has_every_condition_once_in_each_order() -> None:
    orders = sessions()
    assert len(orders) == ORDERS
    for steps in orders:
        driven = [each.condition for each in steps if each.kind == "drive"]
        assert sorted(driven) == sorted(CONDITION_NAMES)
        assert all(word_of(each) for each in steps)


def test_type_is_dark_on_light_cells_only() -> None:
    assert is_light("white")
    assert not is_light(matplotlib.colors.to_hex((0.1, 0.2, 0.4)))
