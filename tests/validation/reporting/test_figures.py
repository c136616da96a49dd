"""Figures of the report: what is drawn of people and of virtual drivers."""

from __future__ import annotations

import math

import numpy as np
import pytest
from matplotlib.figure import Figure
from statsmodels.stats.proportion import proportion_confint

from costeer.pages.style import styled
from costeer.validation.look import HUMAN, LINE, num_bins
from costeer.validation.people.findings import RealComparison
from costeer.validation.people.ranges import QUANTITIES
from costeer.validation.reporting.people_figures import (
    OTHERS,
    draw_people,
    draw_spectra,
    group_of,
    wilson,
)
from tests.validation.reporting.made_up import evidence, people


def drawn(comparisons: list[RealComparison]) -> dict[str, Figure]:
    with styled():
        shown = {each.name: each.figure for each in draw_people(comparisons)}
    return {name: figure for name, figure in shown.items() if figure is not None}


def colours(figure: Figure) -> set[str]:
    return {str(line.get_color()) for line in figure.axes[0].lines}


@pytest.mark.parametrize(("part", "whole"), [(42, 50), (0, 8), (30, 30)])
def test_the_interval_of_a_share_is_that_of_statsmodels(part: int, whole: int) -> None:
    expected = proportion_confint(part, whole, method="wilson")
    # 1.96 is rounded there to no fewer digits than here: 1e-5 of an end.
    assert wilson(part / whole, whole) == pytest.approx(expected, abs=1e-4)


def test_every_quantity_stands_in_a_figure_of_its_recordings() -> None:
    nothing = np.empty(0)
    groups = {
        each.name: group_of(
            RealComparison(**each._asdict(), people=nothing, drivers=nothing)
        )
        for each in QUANTITIES
    }
    assert OTHERS not in groups.values()
    assert groups["R1"].name == "people-lane-changes"
    assert groups["R7"].name == "people-glances"


def test_people_and_drivers_are_drawn_in_their_colours() -> None:
    figure = drawn(people())["people-lane-changes"]
    assert colours(figure) == {HUMAN, LINE}


def test_published_values_are_crosses_where_recordings_are_absent() -> None:
    for there, crosses in ((True, 0), (False, 1)):
        (axes,) = drawn(people(there)[:1])["people-lane-changes"].axes[:1]
        marks = [line for line in axes.lines if line.get_marker() == "+"]
        assert len(marks) == crosses
        if marks:
            assert list(marks[0].get_xdata()) == [4.2, 5.6, 7.7]


def test_the_median_is_marked_at_one_half() -> None:
    (axes,) = drawn(people()[:1])["people-lane-changes"].axes[:1]
    dots = {
        str(line.get_color()): (float(line.get_xdata()[0]), float(line.get_ydata()[0]))
        for line in axes.lines
        if line.get_marker() == "o"
    }
    assert dots == {HUMAN: (6.0, 0.5), LINE: (6.0, 0.5)}


def test_a_quantity_without_any_value_is_an_empty_panel() -> None:
    empty = np.array([math.nan])
    nobody = people()[0]._replace(people=empty, drivers=empty)
    assert len(drawn([nobody])) == 1


def test_absent_recordings_have_no_spectrum() -> None:
    found = evidence().spectra
    assert found is not None
    with styled():
        exhibit = draw_spectra(found)
    assert exhibit.figure is not None
    labels = [line.get_label() for line in exhibit.figure.axes[0].lines]
    assert labels == ["people, instrumented car", "virtual drivers"]


def test_few_values_have_few_bins() -> None:
    assert [num_bins(amount, 28) for amount in (1, 25, 100, 10_000)] == [6, 10, 20, 28]
