"""The folder of a validation report: one page, two tables, its figures."""

from __future__ import annotations

import csv
import html
import re
import shutil
from pathlib import Path
from types import ModuleType

import pytest

from costeer.drivers.population import ON_THE_ROAD, SIMULATOR
from costeer.validation.intention import report as judgement
from costeer.validation.reporting import report, summary
from costeer.validation.reporting.report import prepare, write_validation
from costeer.validation.reporting.sections import page_sections
from costeer.validation.targets import TARGETS
from tests.validation.reporting.made_up import SEED, bare, evidence

pytestmark = pytest.mark.slow


def written(folder: Path, **options: bool) -> str:
    prepare(folder)
    return write_validation(folder, evidence(**options)).read_text("utf-8")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("validation") / "new" / "report"
    written(path)
    return path


@pytest.fixture(scope="module")
def page(folder: Path) -> str:
    return (folder / "report.html").read_text("utf-8")


def rows(file: Path) -> dict[str, dict[str, str]]:
    with file.open(encoding="utf-8", newline="") as stream:
        return {row["name"]: row for row in csv.DictReader(stream)}


def words(page: str) -> str:
    """The text of a page in one line."""
    return html.unescape(" ".join(re.sub(r"<[^>]+>", " ", page).split()))


def table(page: str, name: str) -> str:
    found = re.search(rf'id="table-{name}">(.*?)</table>', page, re.DOTALL)
    assert found is not None
    return words(found[1])


def test_the_sections_stand_in_their_order(page: str) -> None:
    assert re.findall(r'<section id="([a-z]+)">', page) == [
        "targets",
        "people",
        "departures",
        "arms",
        "resistance",
        "stability",
        "population",
        "making",
    ]


def test_the_summary_says_who_drove_and_what_came_out(page: str) -> None:
    opening = words(page.split("<nav")[0])
    who = f"6 virtual drivers, population 3 (virtual), seed {SEED}."
    assert who in opening
    assert "of 12 targets are met" in opening
    assert "The largest miss is M" in opening
    assert "1 of 2 quantities of people are met; missed: R2." in opening
    assert "Of 4 drivers 1 oscillate and 1 leave the road." in opening
    assert "No run with the guidance of a study was looked at." in opening


def test_another_population_is_named_and_held_to_its_domain() -> None:
    made = evidence()
    road = made._replace(
        drawn=made.drawn._replace(population=ON_THE_ROAD),
        driving=made.driving._replace(population=ON_THE_ROAD),
    )
    assert summary.subtitle(road) == (
        f"6 virtual drivers, population 3 (virtual-traffic), seed {SEED}."
    )
    assert "population 3 (virtual-traffic)" in summary.looked_at(road)[0]
    making = page_sections(road, {})[-1]
    assert "--population virtual-traffic" in making.text[0]
    assert "--population" not in page_sections(made, {})[-1].text[0]
    shown = {row[0]: row[2] for row in page_sections(road, {})[0].items[0].rows}
    assert shown["M4"] == "5 to 6.3"
    shown = {row[0]: row[2] for row in page_sections(made, {})[0].items[0].rows}
    assert shown["M4"] == "4.6 to 5.6"


def test_what_is_of_another_domain_is_said_and_not_counted() -> None:
    made = evidence()
    duration, share, torque = made.people
    away = share._replace(domain="traffic", elsewhere=True)
    told = summary.people_sentence(made._replace(people=[duration, away, torque]))
    assert told.startswith("1 of 1 quantities of people are met. R2 are of another")
    assert "(traffic; these drivers: simulator)" in told
    assert summary.elsewhere_sentence(made) == ""


def test_every_target_has_range_value_spread_verdict_and_source(page: str) -> None:
    shown = table(page, "targets")
    for target in TARGETS[SIMULATOR]:
        assert f"{target.name} {target.quantity} [{target.unit}]" in shown
        assert target.source in shown
    assert shown.count("met") >= 1
    assert "missed by" in shown


def test_the_page_needs_nothing_but_itself(page: str) -> None:
    assert "<script src" not in page
    assert not re.search(r"""(?:src|href)=["'](?!#)""", page.replace("xlink:href", ""))
    assert "@import" not in page


def test_every_figure_has_a_title_a_description_and_a_file(
    folder: Path, page: str
) -> None:
    names = set(re.findall(r'<figure id="figure-([a-z-]+)"', page))
    assert {file.stem for file in (folder / "figures").iterdir()} == names
    for name in names:
        told = re.search(rf'<desc id="{name}-desc">(.*?)</desc>', page, re.DOTALL)
        assert told is not None
        assert len(told[1]) > 40
    assert {"manual-driving", "test-retest", "arms", "population"} <= names
    assert {"people-lane-changes", "people-glances", "people-others"} <= names


@pytest.mark.slow  # a report of its own
def test_the_same_evidence_gives_the_same_bytes(folder: Path, tmp_path: Path) -> None:
    written(tmp_path)
    for file in sorted(folder.rglob("*")):
        if file.is_file():
            assert (tmp_path / file.relative_to(folder)).read_bytes() == (
                file.read_bytes()
            ), file.name


def test_targets_csv_has_value_interval_spread_and_verdict(folder: Path) -> None:
    found = rows(folder / "targets.csv")
    assert list(found) == [target.name for target in TARGETS[SIMULATOR]]
    sdlp = found["M1"]
    assert float(sdlp["value_low_95"]) < float(sdlp["value"])
    assert float(sdlp["value"]) < float(sdlp["value_high_95"])
    assert sdlp["met"] == "true"
    assert float(sdlp["test_retest"]) == pytest.approx(1.0)


def test_real_csv_has_both_sides_and_the_verdict(folder: Path) -> None:
    found = rows(folder / "real.csv")
    assert [row["verdict"] for row in found.values()] == ["met", "missed", "reported"]
    assert float(found["R1"]["people_50"]) == pytest.approx(6.0)
    assert float(found["R2"]["missed_by"]) == pytest.approx(10.0)
    assert found["R3"]["low"] == ""


@pytest.mark.slow  # a report of its own
def test_without_recordings_published_values_stand_there(tmp_path: Path) -> None:
    page = written(tmp_path, there=False)
    assert "Recordings of people were not there" in words(page)
    shown = table(page, "people")
    assert "4.20 / 5.60 / 7.70 published" in shown
    assert "recordings absent" in shown
    assert rows(tmp_path / "real.csv")["R1"]["num_people"] == "0"


@pytest.fixture(scope="module")
def without(folder: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A report of manual driving alone over one of everything."""
    path = tmp_path_factory.mktemp("bare") / "report"
    shutil.copytree(folder, path)
    prepare(path)
    write_validation(path, bare())
    return path


@pytest.mark.slow  # a report of its own
def test_a_section_without_its_input_says_so(without: Path) -> None:
    page = (without / "report.html").read_text("utf-8")
    for sentence in (
        "Nothing was compared with people.",
        "The arms were not tested.",
        "No wrong guidance was tried.",
        "Stability was not looked at.",
    ):
        assert sentence in page
    assert (without / "real.csv").read_text("utf-8").startswith("name,quantity,unit")


@pytest.mark.slow
def test_a_figure_of_an_earlier_report_does_not_stay(
    folder: Path, without: Path
) -> None:
    assert (folder / "figures" / "arms.svg").exists()
    assert not (without / "figures" / "arms.svg").exists()


@pytest.mark.parametrize("module", [report, judgement])
def test_a_folder_with_other_things_is_refused(
    module: ModuleType, tmp_path: Path
) -> None:
    (tmp_path / "thesis.tex").write_text("")
    with pytest.raises(ValueError, match=r"it holds thesis\.tex"):
        module.prepare(tmp_path)
