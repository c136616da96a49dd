"""The report on people: the same figures and tests, and what only people give."""

from __future__ import annotations

import csv
import html
import re
import shutil
from pathlib import Path

import pytest

from costeer.cli import main
from costeer.study.configuration import StudySettings
from costeer.study.outcome import FRIEDMAN, WILCOXON
from costeer.study.report import STATISTICS_FILES
from costeer.study.run import run_study
from tests.sessions.conftest import DRIVEN
from tests.sessions.made_up import LENGTH
from tests.study.fakes import made_up

pytestmark = pytest.mark.slow  # a report of its own

VIRTUAL = StudySettings(
    participants=3, conditions=DRIVEN, intention="scripted", length=LENGTH, seed=3
)


@pytest.fixture(scope="module")
def reported(studied: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy of the study with its report, beside virtual drivers."""
    room = tmp_path_factory.mktemp("reported")
    shutil.copytree(studied, room / "study")
    run_study(room / "virtual", VIRTUAL, jobs=1, report=None, simulate=made_up)
    given = ["report", str(room / "study"), "--beside", str(room / "virtual")]
    assert main(given) == 0
    return room / "study"


@pytest.fixture(scope="module")
def page(reported: Path) -> str:
    return (reported / "report.html").read_text("utf-8")


@pytest.fixture(scope="module")
def words(page: str) -> str:
    """What the page says, without its drawings."""
    text = re.sub(r"<style>.*?</style>|<svg.*?</svg>", "", page, flags=re.DOTALL)
    text = html.unescape(re.sub(r"<[^>]+>", " ", text))
    return " ".join(text.split())


def rows(folder: Path, name: str) -> list[dict[str, str]]:
    with (folder / name).open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def test_it_is_of_people_and_not_complete(words: str) -> None:
    assert "3 participants drove the conditions" in words
    assert "8 of 12 trials are there" in words
    assert "These are virtual drivers" not in words


def test_workload_has_its_figures_and_tests(reported: Path, page: str) -> None:
    for name in ("tlx-raw", "tlx-weighted", "workload-items", "inconsistency-timing"):
        assert f'<figure id="figure-{name}"' in page
        assert (reported / "figures" / f"{name}.svg").is_file()
    tested = {row["analysis"] for row in rows(reported, "answers_tests.csv")}
    assert FRIEDMAN in tested
    pairs = rows(reported, "answers_pairs.csv")
    assert {row["measure"] for row in pairs} >= {"effort", "performance"}
    assert {row["analysis"] for row in pairs} >= {WILCOXON, "within"}
    summaries = rows(reported, "summaries.csv")
    assert {"tlx_raw", "tlx_weighted"} <= {row["measure"] for row in summaries}


def test_missing_cells_are_named(reported: Path) -> None:
    dropped = rows(reported, "dropped.csv")
    assert ("sdlp", "P02", "weak-gentle") in {tuple(r.values())[:3] for r in dropped}


def test_the_exclusion_log_gives_reasons(words: str) -> None:
    log = words.split("Exclusion log", 2)[-1]
    for reason in ("the screen went dark", "looked at the phone", "felt sick"):
        assert reason in log


def test_methods_are_ready_to_paste(words: str) -> None:
    for part in (
        "Age: mean 22.0 years (SD 1.0, 21 to 23)",
        "Gender: 3 women",
        "Participants held: Simucube 2",
        "inconsistency threshold 0.03 W",
        "8 trials were analysed",
        "1 aborted",
        "Friedman's test",
        "nasa-tlx version 1 (Hart",
        "The latency from wheel to screen was not recorded",
    ):
        assert part in words


def test_agreement_is_told(reported: Path, words: str) -> None:
    found = rows(reported, "agreement.csv")
    assert {row["condition"] for row in found} == set(DRIVEN)
    inside = sum(row["inside"] == "true" for row in found)
    assert f"{inside} of {len(found)} means of people lie" in words
    trials = [r for r in rows(reported, "trials.csv") if r["condition"] == "manual"]
    mean = sum(float(row["sdlp"]) for row in trials) / len(trials)
    assert float(found[0]["mean_people"]) == pytest.approx(mean)


def test_the_codebook_explains_the_tables_of_the_report(reported: Path) -> None:
    known = {(r["file"], r["column"]) for r in rows(reported, "codebook.csv")}
    names = [each.name for each in STATISTICS_FILES]
    for name in [*names, *(f"answers_{each}" for each in names), "agreement.csv"]:
        head = (reported / name).read_text("utf-8").split("\n", 1)[0].split(",")
        assert {(name, column) for column in head} <= known


def test_the_same_folder_gives_the_same_report(reported: Path, page: str) -> None:
    assert main(["report", str(reported)]) == 0
    again = (reported / "report.html").read_text("utf-8")
    assert "People beside virtual drivers" in page
    assert "People beside virtual drivers" not in again
    assert not (reported / "agreement.csv").exists()
    assert not (reported / "figures" / "agreement.svg").exists()
