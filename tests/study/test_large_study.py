"""A study of a thousand drivers has a report that can be read."""

from __future__ import annotations

import numpy as np
import pandas as pd

from costeer.pages.style import styled
from costeer.pages.tables import MOST_ROWS, Table, shortened
from costeer.study.figures import bars
from costeer.study.material import StudyMaterial
from costeer.study.quantities import QUANTITIES


def test_a_long_table_is_cut_and_says_so() -> None:
    rows = tuple((str(row),) for row in range(MOST_ROWS + 5))
    table = Table("t", "Title", "Note.", ("Row",), rows)
    cut = shortened(table)
    assert len(cut.rows) == MOST_ROWS
    assert cut.note == "Note. 5 more rows stand in the CSV files of the study."


def test_a_table_that_fits_stays_as_it_is() -> None:
    table = Table("t", "Title", "", ("Row",), (("1",),))
    assert shortened(table) is table


def test_a_crowd_of_participants_is_not_drawn_one_by_one(
    material: StudyMaterial,
) -> None:
    copies = [
        material.trials.assign(participant=material.trials["participant"] + 3 * times)
        for times in range(20)
    ]
    crowd = material._replace(trials=pd.concat(copies, ignore_index=True))
    with styled():
        few, many = (bars.draw(each, QUANTITIES[0]) for each in (material, crowd))
    assert "circles" in few.caption
    assert "circles" not in many.caption
    assert few.figure is not None
    assert many.figure is not None
    drawn = [
        sum(np.size(line.get_xdata()) for line in figure.axes[-1].get_lines())
        for figure in (few.figure, many.figure)
    ]
    assert drawn[1] < drawn[0]
