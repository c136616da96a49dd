"""Small drawings of the worst cases: legible, whichever and however many they are."""

from __future__ import annotations

from pathlib import Path

import pytest

from costeer.comparison.drawings import worst_drawings
from costeer.comparison.worst import WORST, WorstCase
from costeer.loop.scenario import TrialSetup
from costeer.pages.publish import legible
from costeer.pages.style import styled
from costeer.records.record import write_record
from tests.comparison.fakes import made_up

LONGEST = "four-design-choices", "expressway-curves"


@pytest.mark.parametrize("number", [1, 3, 4, 5, 12])
def test_no_words_meet_or_leave_the_figure(tmp_path: Path, number: int) -> None:
    (tmp_path / WORST).mkdir()
    setup = TrialSetup(condition="strong-normal", length=1800.0)
    write_record(tmp_path / WORST / "one.parquet", made_up(setup))
    method, scenario = LONGEST
    case = WorstCase(
        method=method,
        scenario=scenario,
        mistake="none",
        participant=49,
        num_collisions=1,
        num_lane_departures=7,
        what="car",
        time=30.0,
        position=583.0,
        record="one.parquet",
    )
    with styled():
        figure = worst_drawings(tmp_path, [case] * number).figure
        assert figure is not None
        assert legible(figure)
