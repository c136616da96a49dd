"""The folder of a judgement: what is in it, what it says, and that it is stable."""

from __future__ import annotations

import csv
import json
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from costeer.intention.features import DISTANCE, full_windows
from costeer.intention.predictors.interface import Predictor
from costeer.pages.style import styled
from costeer.training.assessment import Asked, assess, assessment_facts
from costeer.training.comparison import Contender
from costeer.training.evaluate import DEFAULTS
from costeer.training.operating import OperatingPoint
from costeer.validation.intention.curve_figures import frontier
from costeer.validation.intention.driver_figures import draw_spread, driver_scores
from costeer.validation.intention.material import Material, looks
from costeer.validation.intention.own_figures import draw_learning
from costeer.validation.intention.report import prepare, write_report
from costeer.validation.intention.words import outcomes
from tests.training.synthetic import drive, drives

pytestmark = pytest.mark.slow

PARAMETERS = DEFAULTS._replace(num_resamples=50, false_per_km=0.5)
CURVES = {"8": [[10, 0.2, 0.1, 0.5, {}], [20, 0.1, 0.05, 0.7, {}]], "16": []}


def nearness(name: str, steepness: float) -> Predictor:
    """The nearer the line the likelier."""

    def probabilities(
        features: NDArray[np.float64], absent: tuple[str, ...]
    ) -> NDArray[np.float64]:
        said = np.exp(-steepness * features[:, DISTANCE])
        return np.where(full_windows(features, absent), said, np.nan)

    return Predictor(name, f"The {name}", "made up", (), probabilities)


def material(num_drivers: int = 3, network: dict[str, Any] | None = None) -> Material:
    asked = Asked(
        rivals=(nearness("rival", 9.0),),
        unfitted=(Contender("other", "The other", "", [], "not fitted"),),
        ablations=True,
    )
    found = assess(
        nearness("judged", 2.0), drives(num_drivers, num_changes=2), asked, PARAMETERS
    )
    facts = assessment_facts(found)
    return Material(found, facts, "made drives", network or {})


@cache
def full() -> Material:
    """A judgement with all there is."""
    return material(network={"curves": CURVES, "hidden_size": 8})


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("report") / "judged"
    prepare(out)
    write_report(out, full())
    return out


def rows(file: Path) -> list[dict[str, str]]:
    with file.open(newline="") as text:
        return list(csv.DictReader(text))


def test_the_folder_holds_page_numbers_tables_and_figures(folder: Path) -> None:
    assert {path.name for path in folder.iterdir()} == {
        "report.html",
        "evaluation.json",
        "predictors.csv",
        "drivers.csv",
        "operating.csv",
        "ablations.csv",
        "figures",
    }
    assert {path.stem for path in (folder / "figures").iterdir()} == {
        "operating-curve",
        "curves",
        "calibration",
        "lead-times",
        "drivers",
        "learning-curves",
    }


def test_the_page_needs_nothing_else(folder: Path) -> None:
    page = (folder / "report.html").read_text()
    assert page.count("<svg") == 6
    assert "src=" not in page
    assert "@import" not in page
    assert "Not in the table: The other. Reason: not fitted." in page
    assert "nan" not in page.lower().split()


def test_tables_hold_the_numbers_of_the_json(folder: Path) -> None:
    facts = json.loads((folder / "evaluation.json").read_text())
    found = rows(folder / "predictors.csv")
    assert [row["predictor"] for row in found] == ["judged", "rival"]
    for row in found:
        own = facts["comparison"]["predictors"][row["predictor"]]
        assert float(row["samples_pr_auc"]) == own["samples"]["pr_auc"]
    assert len(rows(folder / "drivers.csv")) == 2 * 3
    assert rows(folder / "ablations.csv")[0]["title"] == "all signals"
    operating = rows(folder / "operating.csv")
    curve = facts["comparison"]["predictors"]["judged"]["operating_curve"]
    own_points = [row for row in operating if row["predictor"] == "judged"]
    assert len(own_points) == len(curve["threshold"])


@pytest.mark.slow
def test_the_same_judgement_gives_the_same_bytes(folder: Path, tmp_path: Path) -> None:
    prepare(tmp_path / "again")
    write_report(tmp_path / "again", full())
    for path in folder.rglob("*"):
        if path.is_file():
            other = tmp_path / "again" / path.relative_to(folder)
            assert path.read_bytes() == other.read_bytes()


def test_a_monotone_change_of_the_score_changes_no_verdict() -> None:
    # The rival says the same in another scale: nobody is better.
    told = dict(outcomes(material(num_drivers=5)))
    assert told["Area under precision and recall against the others"] == (
        "Tied with The rival."
    )


def test_three_drivers_are_too_few_for_a_verdict() -> None:
    told = dict(outcomes(full()))
    assert told["Area under precision and recall against the others"] == (
        "Not to be told from (too few drivers) The rival."
    )


@pytest.mark.slow
def test_an_earlier_report_is_written_over_and_its_extra_figures_go(
    tmp_path: Path,
) -> None:
    out = tmp_path / "judged"
    prepare(out)
    write_report(out, full())
    prepare(out)
    write_report(out, full()._replace(network={}))
    assert not (out / "figures" / "learning-curves.svg").exists()
    assert "holds no learning curves" in (out / "report.html").read_text()


@pytest.mark.slow
def test_one_driver_has_no_spread() -> None:
    with styled():
        assert "one driver" in draw_spread(material(num_drivers=1)).missing


def test_without_curves_nothing_is_drawn_of_the_learning() -> None:
    with styled():
        assert draw_learning(full()._replace(network={})).figure is None


def test_each_predictor_looks_its_own_way_and_the_judged_one_is_solid() -> None:
    found = looks(full())
    assert len(set(found.values())) == len(found) == 2
    assert found["judged"].line == (0.0, ())


def test_each_driver_has_three_scores() -> None:
    areas, leads, false = driver_scores(full().assessment.judged)
    assert len(areas) == len(leads) == len(false) == 3
    assert ((areas > 0.0) & (areas <= 1.0)).all()
    total = full().facts["at_false_rate"]["false_per_km"]
    distances = full().assessment.judged.judgement.operating.kilometres
    assert np.average(false, weights=distances) == pytest.approx(total)


def test_the_frontier_only_rises() -> None:
    points = [
        OperatingPoint(0.9, 0.0, 1.0, 0.1),
        OperatingPoint(0.7, 2.0, 1.5, 0.1),
        OperatingPoint(0.5, 1.0, 2.0, 0.0),
        OperatingPoint(0.3, 3.0, 2.5, 0.0),
    ]
    assert frontier(points) == ([0.0, 1.0, 3.0], [1.0, 2.0, 2.5])


def test_quiet_driving_is_judged_without_a_crossing() -> None:
    found = assess(
        nearness("judged", 2.0), [drive(1, num_changes=0)], Asked(), PARAMETERS
    )
    assert found.comparison is None
    assert assessment_facts(found)["at_false_rate"] == {}
