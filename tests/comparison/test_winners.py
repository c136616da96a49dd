"""Effects, winners, ties and losses of numbers whose outcome is known."""

from __future__ import annotations

import math

import numpy as np
import pytest
from matplotlib.lines import Line2D

from costeer.comparison.criteria import AIMS, CRITERIA, SPEAKING
from costeer.comparison.design import Course, Entrant, cells_of
from costeer.comparison.effects import effect_rows, mean_rows, paired_effect
from costeer.comparison.figures import over_scenarios, panel_grid
from costeer.comparison.measures import COLUMNS
from costeer.comparison.results import Failure
from costeer.comparison.tables import winner_text
from costeer.comparison.winners import (
    NOBODY,
    TIE,
    WINNER,
    WinnerRow,
    losses,
    winner_rows,
)
from costeer.comparison.worst import worst_drives
from costeer.pages.style import Margins, styled
from tests.comparison.made_up import Given, results

NAN = math.nan
NAMES = ("methods", "sdlp", "road", "", "none", "a", "b")
EIGHT = [0.10, 0.12, 0.14, 0.16, 0.18, 0.20, 0.22, 0.24]


def winner(
    given: Given, measure: str = "sdlp", failures: tuple[Failure, ...] = ()
) -> WinnerRow:
    found = results(given, measure, failures)
    rows = winner_rows(found, effect_rows(found))
    return next(row for row in rows if row.measure == measure)


def plus(numbers: list[float], more: float) -> list[float]:
    return [each + more for each in numbers]


def test_a_paired_effect_is_student_s_in_closed_form() -> None:
    # Differences 1, 2, 3; with two degrees of freedom p is 1 - t / sqrt(2 + t²).
    row = paired_effect(NAMES, np.array([2.0, 4.0, 6.0]), np.array([1.0, 2.0, 3.0]))
    t = 2.0 * math.sqrt(3.0)
    quantile = math.sqrt(2.0 * 0.95**2 / (1.0 - 0.95**2))  # of t, df 2, at 0.975
    assert row.n == 3
    assert row.difference == pytest.approx(2.0)
    assert row.statistic == pytest.approx(t)
    assert row.p == pytest.approx(1.0 - t / math.sqrt(2.0 + t * t))
    assert row.low == pytest.approx(2.0 - quantile / math.sqrt(3.0))
    assert row.high == pytest.approx(2.0 + quantile / math.sqrt(3.0))


def test_only_drivers_with_both_values_are_a_pair() -> None:
    first = np.array([2.0, NAN, 4.0, 6.0, 100.0])
    second = np.array([1.0, 50.0, 2.0, 3.0, NAN])
    row = paired_effect(NAMES, first, second)
    assert (row.n, row.mean_first, row.mean_second) == (3, 4.0, 2.0)


def test_pairing_shows_what_the_spread_between_drivers_would_hide() -> None:
    # Drivers differ by 0.14 m, the methods by 0.002 m for each of them.
    wobble = [1e-4 * (-1) ** k for k in range(8)]
    better = [e - 0.002 + w for e, w in zip(EIGHT, wobble, strict=True)]
    row = winner({"a": EIGHT, "b": better})
    assert (row.verdict, row.best) == (WINNER, "b")


@pytest.mark.parametrize(("n", "p"), [(4, 0.125), (6, 0.03125)])
def test_one_difference_for_all_is_judged_by_the_signs(n: int, p: float) -> None:
    row = paired_effect(NAMES, np.full(n, 3.0), np.full(n, 1.0))
    assert (row.p, row.low, row.high) == (p, 2.0, 2.0)
    same = paired_effect(NAMES, np.full(n, 3.0), np.full(n, 3.0))
    assert (same.p, same.low, same.high) == (1.0, 0.0, 0.0)


def test_less_sdlp_wins_and_more_time_to_the_line_wins() -> None:
    given = {"a": EIGHT, "b": plus(EIGHT, 0.05), "c": plus(EIGHT, 0.1)}
    assert winner(given).best == "a"
    row = winner(given, "line_crossing_time_minimum")
    assert (row.verdict, row.best, row.tied) == (WINNER, "c", "")
    # All drivers differ by 0.05: the interval has no width.
    assert winner_text(row) == "c wins\n+0.05\n[0.05,\u00a00.05]\nto b"


def test_no_difference_is_a_tie() -> None:
    noise = [0.01, -0.01, 0.01, -0.01, 0.01, -0.01, 0.012, -0.01]
    near = [each + more for each, more in zip(EIGHT, noise, strict=True)]
    row = winner({"a": near, "b": EIGHT, "c": plus(EIGHT, 0.1)})
    assert (row.verdict, row.best, row.tied) == (TIE, "b", "a")
    assert winner_text(row) == "tie: b,\na"
    alike = winner({"a": EIGHT, "b": EIGHT, "c": EIGHT})
    assert (alike.verdict, alike.tied) == (TIE, "b; c")
    assert winner_text(alike) == "tie of all 3"


def test_a_difference_that_many_comparisons_explain_is_a_tie() -> None:
    # Five signs of one kind have p = 0.0625; six 0.03125, and twice that in a family
    # of which one other of two p values is 1: 2 x 0.03125.
    assert winner({"a": EIGHT[:6], "b": plus(EIGHT[:6], 1.0)}).verdict == WINNER
    first, second = (
        {"a": EIGHT[:6], "b": plus(EIGHT[:6], 1.0)},
        {
            "a": EIGHT[:6],
            "b": EIGHT[:6],
        },
    )
    found = results({("one", "none"): first, ("two", "none"): second})
    rows = [r for r in effect_rows(found) if r.measure == "sdlp"]
    assert [row.p_corrected for row in rows] == [0.0625, 1.0]
    assert [row.better for row in rows] == ["", ""]


def test_who_fails_or_has_few_values_is_not_ranked() -> None:
    broken = Failure("a", "road", "none", 3, "it broke")
    row = winner(
        {"a": EIGHT, "b": plus(EIGHT, 0.1), "c": plus(EIGHT, 0.2)}, failures=(broken,)
    )
    assert (row.best, row.not_ranked, row.num_ranked) == ("b", "a", 2)
    few = [0.01, 0.01, 0.01, NAN, NAN, NAN, NAN, NAN]
    row = winner({"a": few, "b": plus(EIGHT, 0.1), "c": plus(EIGHT, 0.2)})
    assert (row.best, row.not_ranked) == ("b", "a")
    assert winner({"a": few, "b": EIGHT}).verdict == NOBODY
    assert winner_text(winner({"a": few, "b": EIGHT})) == "–"


def test_losses_are_the_method_minus_the_one_that_beats_it() -> None:
    given = {"manual": EIGHT, "ibhs": plus(EIGHT, 0.05), "c": plus(EIGHT, 0.1)}
    found = losses(effect_rows(results(given)), "ibhs")
    assert [(each.winner, each.scenario, each.aim) for each in found] == [
        ("manual", "road", "performance")
    ]
    assert found[0].difference == pytest.approx(0.05)
    assert losses(effect_rows(results(given)), "manual") == []


def test_a_mistake_is_compared_with_the_same_method_without_it() -> None:
    found = results(
        {
            ("road", "none"): {"a": EIGHT, "b": EIGHT},
            ("road", "late"): {"a": plus(EIGHT, 0.3), "b": EIGHT},
        }
    )
    rows = {r.method: r for r in effect_rows(found) if r.kind == "mistakes"}
    assert rows["a"].difference == pytest.approx(0.3)
    assert (rows["a"].first, rows["a"].second, rows["a"].better) == (
        "late",
        "none",
        "none",
    )
    assert (rows["b"].difference, rows["b"].better) == (0.0, "")


def test_means_are_over_the_drivers_who_have_a_value() -> None:
    (row,) = [
        each
        for each in mean_rows(results({"a": [1.0, 3.0, NAN]}))
        if each.measure == "sdlp"
    ]
    assert (row.n, row.mean) == (2, 2.0)
    assert row.sd == pytest.approx(math.sqrt(2.0))


def test_trade_offs_take_the_roads_and_drivers_that_all_methods_have() -> None:
    found = results(
        {
            ("one", "none"): {"a": [1.0, 2.0, 3.0], "b": [2.0, 4.0, NAN]},
            ("two", "none"): {"a": [9.0, 9.0, 9.0], "b": [NAN, NAN, NAN]},
        }
    )
    points = over_scenarios(found, "sdlp")
    # Road two says nothing of b, so it does not count for a either.
    assert points["a"].mean == pytest.approx(2.0)
    assert points["b"].mean == pytest.approx(3.0)


def test_the_worst_of_a_method_is_a_collision_then_departures_then_the_first() -> None:
    found = results(
        {
            ("one", "none"): {"a": [0.0, 2.0, 2.0], "b": [0.0, 0.0, 0.0]},
            ("two", "none"): {"a": [9.0, 0.0, 1.0], "b": [0.0, 1.0, 3.0]},
        },
        "num_lane_departures",
    )
    names = ("a", "b")
    entrants = [Entrant(name, name, True) for name in names]
    courses = [Course(name, name, 1.0, 1.0) for name in ("one", "two")]
    cells = cells_of(entrants, courses, ("none",), ())

    def worst() -> list[tuple[str, str, int]]:
        drives = worst_drives(found, cells)
        return [
            (d.cell.entrant.name, d.cell.course.name, d.participant) for d in drives
        ]

    assert worst() == [("a", "two", 1), ("b", "two", 3)]
    hit = COLUMNS.index("num_collisions")
    found.values["one", "none", "a"][1:, hit] = 1.0
    assert worst() == [("a", "one", 2), ("b", "two", 3)]
    found.values["two", "none", "b"][:] = math.nan
    assert worst() == [("a", "one", 2)]


def test_each_aim_has_a_measure_that_speaks_for_it() -> None:
    assert {each.aim for each in SPEAKING} == set(AIMS)
    assert len(AIMS) == 6
    assert len({each.name for each in CRITERIA}) == len(CRITERIA)
    assert all(each.better for each in SPEAKING)


def test_a_winner_s_lead_is_its_paired_difference_to_the_next_best() -> None:
    # a - b is -0.05 for every driver and the name of the better one comes last.
    noise = [0.01, -0.01, 0.02, -0.02, 0.01, -0.01, 0.02, -0.02]
    next_best = [x + 0.05 + e for x, e in zip(EIGHT, noise, strict=True)]
    row = winner({"c": plus(EIGHT, 0.3), "b": next_best, "a": EIGHT})
    assert (row.best, row.second) == ("a", "b")
    assert row.difference == pytest.approx(-0.05)
    # Student's t with 7 degrees of freedom, 2.3646, times the standard error.
    half = 2.3646 * np.std(noise, ddof=1) / math.sqrt(8.0)
    assert (row.low, row.high) == pytest.approx((-0.05 - half, -0.05 + half), rel=1e-4)
    assert winner_text(row).splitlines()[0] == "a wins"


def test_what_never_happens_is_no_evidence() -> None:
    nothing = [0.0] * 8
    row = winner({"a": nothing, "b": nothing}, "num_lane_departures")
    assert (row.verdict, row.note) == (TIE, "no events")
    assert winner_text(row) == "tie (no events)"
    once = [1.0, *nothing[1:]]
    row = winner({"a": nothing, "b": nothing, "c": once}, "num_lane_departures")
    assert (row.verdict, row.note) == (TIE, "")
    assert winner_text(row) == "tie of all 3"
    # A measure that is no count says nothing of events where it is zero.
    assert winner({"a": nothing, "b": nothing}, "overshoot").note == ""


@pytest.mark.parametrize("number", range(1, 8))
def test_no_place_of_a_grid_is_empty(number: int) -> None:
    handle = Line2D([], [], label="a")
    with styled():
        grid = panel_grid(number, 30.0, Margins(), [handle])
    assert len(grid.panels) == number
    every = grid.figure.axes
    empty = [axes for axes in every if axes not in grid.panels]
    assert all(not axes.axison for axes in empty)
    assert bool(empty) == any(axes.get_legend() is not None for axes in empty)
