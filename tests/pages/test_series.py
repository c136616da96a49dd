"""What is told of a figure is what was drawn."""

from __future__ import annotations

import csv
import io
import json
from typing import Any

import numpy as np
import pytest
from matplotlib.figure import Figure

from costeer.pages.series import (
    HEADER,
    Other,
    name_parts,
    page_values,
    say,
    spans,
    table,
)
from costeer.pages.style import Margins, new_figure, panels, styled, svg_text

POINTS_PER_MM = 72.0 / 25.4


def drawn() -> Figure:
    """A panel of 80 mm by 40 mm, 10 mm from each edge, with a line, marks and a bar."""
    figure = new_figure(100.0, 60.0)
    margins = Margins(left=10.0, right=10.0, top=10.0, bottom=10.0)
    axes = panels(figure, 1, 1, margins)[0][0]
    say(axes.plot([0.0, 4.0, 8.0], [0.0, 2.0, 0.0])[0], "line", key="k")
    (marks,) = axes.plot([2.0, 6.0], [1.0, 3.0], linestyle="none", marker="o")
    say(marks, "mark", points=("a", "b"), low=(0.5, 2.5), high=(1.5, 3.5))
    say(axes.bar(4.0, 3.0, width=1.0)[0], "bar")
    spans(axes, [1.0], [3.0], "grey", key="shade")
    axes.plot([0.0, 8.0], [1.0, 1.0])  # a helper that nobody named
    axes.set_xlim(0.0, 8.0)
    axes.set_ylim(0.0, 4.0)
    axes.set_xlabel("Time [s]")
    axes.set_ylabel("less ← way [m] → more")
    return figure


def told(*others: Other) -> dict[str, Any]:  # Any: JSON
    with styled():
        return dict(json.loads(page_values(drawn(), others)))


def test_the_table_has_a_row_for_every_point_that_was_named() -> None:
    with styled():
        header, *rows = csv.reader(io.StringIO(table(drawn())))
    assert tuple(header) == HEADER
    assert [row[3:] for row in rows] == [
        ["line", "", "0", "0", "", ""],
        ["line", "", "4", "2", "", ""],
        ["line", "", "8", "0", "", ""],
        ["mark", "a", "2", "1", "0.5", "1.5"],
        ["mark", "b", "6", "3", "2.5", "3.5"],
        ["bar", "", "4", "3", "", ""],
    ]
    assert {tuple(row[:3]) for row in rows} == {
        ("", "Time [s]", "less ← way [m] → more")
    }


def test_a_figure_of_which_nothing_was_named_has_no_data() -> None:
    with styled():
        figure = new_figure(50.0, 50.0)
        figure.add_subplot().plot([0.0, 1.0], [0.0, 1.0])
        assert table(figure) == page_values(figure) == ""


def test_marks_stand_where_they_are_drawn_and_say_their_interval() -> None:
    # 10 mm of margin and 10 mm for each second or metre, from the upper left corner.
    places = {words: (x, y) for x, y, words in told()["marks"]}
    at = {
        words: tuple(np.round(np.array(p) / POINTS_PER_MM, 1))
        for words, p in places.items()
    }
    assert at == {
        "mark, a: 1 m [0.5, 1.5]": (30.0, 40.0),
        "mark, b: 3 m [2.5, 3.5]": (70.0, 20.0),
        "bar: 3 m": (50.0, 20.0),
    }


def test_a_panel_is_told_with_its_box_and_limits() -> None:
    (panel,) = told()["panels"]
    box = np.array(panel["box"]) / POINTS_PER_MM
    assert box == pytest.approx([10.0, 10.0, 90.0, 50.0], abs=0.01)
    assert (panel["x"], panel["y"]) == ([0.0, 8.0], [0.0, 4.0])
    assert panel["names"] == ["Time [s]", "less ← way [m] → more"]


def test_another_participants_line_and_shading_lie_where_theirs_would_be_drawn() -> (
    None
):
    values = {"k": ([0.0, 8.0], [4.0, 2.0]), "shade": ([5.0], [6.0])}
    told_of = told(Other("P2", "Theirs.", values))
    (curve,) = told_of["curves"]
    (other,) = told_of["others"]
    assert (other["name"], other["caption"]) == ("P2", "Theirs.")
    numbers = {
        name: np.array(path.replace("M", " ").replace("L", " ").split(), float)
        for name, path in other["paths"].items()
    }
    line = numbers.pop(curve[0]).reshape(-1, 2) / POINTS_PER_MM
    # Paths are rounded to a tenth of a point, 0.04 mm.
    assert line == pytest.approx(np.array([[10.0, 10.0], [90.0, 30.0]]), abs=0.03)
    (box,) = (each.reshape(-1, 2) / POINTS_PER_MM for each in numbers.values())
    assert np.ptp(box, axis=0) == pytest.approx([10.0, 40.0], abs=0.05)
    assert box.min(axis=0) == pytest.approx([60.0, 10.0], abs=0.03)


def test_what_another_participant_has_not_is_not_drawn() -> None:
    (other,) = told(Other("P2", "Theirs.", {}))["others"]
    assert set(other["paths"].values()) == {""}


def test_the_names_told_are_those_in_the_drawing() -> None:
    with styled():
        figure = drawn()
        name_parts(figure)
        values = json.loads(page_values(figure))
        svg = svg_text(figure, "f", "F")
    assert all(f'id="{name}"' in svg for name, _, _ in values["curves"])
