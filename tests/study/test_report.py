"""The report: one file that says what the tables say, the same every time."""

from __future__ import annotations

import csv
import html
import re
import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest

from costeer.pages.numerals import number, signed
from costeer.study.figures.catalogue import FIGURE_NAMES
from costeer.study.material import StudyMaterial
from costeer.study.quantities import BY_STRENGTH, QUANTITIES, WORKLOAD, Quantity
from costeer.study.report import NUM_STEPS, write_report
from tests.study.fakes import contents

TABLES = ("tests.csv", "pairs.csv", "summaries.csv", "dropped.csv")


@pytest.fixture(scope="module")
def page(reported: Path) -> str:
    return (reported / "report.html").read_text("utf-8")


def rows(file: Path) -> list[dict[str, str]]:
    with file.open(encoding="utf-8", newline="") as stream:
        return list(csv.DictReader(stream))


def tables(page: str) -> dict[str, list[list[str]]]:
    """Cells of each table of the page by its name, header left out."""
    found = {}
    for name, body in re.findall(
        r'id="table-([a-z-]+)">(.*?)</table>', page, re.DOTALL
    ):
        lines = re.findall(r"<tr>(.*?)</tr>", body.split("</thead>")[1], re.DOTALL)
        cells = [
            re.findall(r"<t[hd][^>]*>(.*?)</t[hd]>", line, re.DOTALL) for line in lines
        ]
        found[name] = [[html.unescape(cell) for cell in line] for line in cells]
    return found


def summary(page: str) -> dict[str, str]:
    """What came out, by its heading."""
    found = re.findall(r"<dt>(.*?)</dt>\s*<dd>(.*?)</dd>", page, re.DOTALL)
    return {html.unescape(title): html.unescape(text) for title, text in found}


def test_a_report_comes_with_tables_and_figures(reported: Path) -> None:
    names = contents(reported).keys()
    of_people = {each.name.replace("_", "-") for each in WORKLOAD}
    of_people |= {"workload-items", "agreement", "traffic"}
    figures = {f"figures/{name}.svg" for name in set(FIGURE_NAMES) - of_people}
    assert figures | {*TABLES, "report.html"} <= names


def test_the_page_fetches_nothing(page: str) -> None:
    # What is left are the names of the two XML languages of SVG, not addresses.
    page = re.sub(r'xmlns(:xlink)?="http://www\.w3\.org/[\w/]+"', "", page)
    assert "http" not in page
    assert not re.search(r"<script[^>]* src|<link|<img|@import|src=|url\((?!#)", page)


def test_every_figure_of_the_folder_is_in_the_page(reported: Path, page: str) -> None:
    for file in (reported / "figures").iterdir():
        assert f'<figure id="figure-{file.stem}"' in page


def test_no_id_comes_twice_and_every_reference_meets_one(page: str) -> None:
    ids = re.findall(r'\bid="([^"]+)"', page)
    assert len(ids) == len(set(ids))
    used = re.findall(r'href="#([^"]+)"|url\(#([^)]+)\)', page)
    used += [
        (name,) for name in " ".join(re.findall(r'labelledby="([^"]+)"', page)).split()
    ]
    assert {name for pair in used for name in pair if name} <= set(ids)


def test_every_drawing_has_a_title_and_a_description(page: str) -> None:
    drawings = re.findall(r"<svg[^>]*>(.{0,60})", page)
    assert drawings
    assert all(each.startswith("<title") for each in drawings)
    assert len(re.findall("<desc ", page)) == len(drawings)


@pytest.mark.parametrize("kind", ["Table", "Figure"])
def test_captions_are_numbered_in_their_order(page: str, kind: str) -> None:
    numbers = re.findall(rf"<b>{kind} (\d+)\.", page)
    assert numbers == [str(place + 1) for place in range(len(numbers))]
    assert numbers


def test_the_page_leads_with_the_answer_then_what_was_run_and_what_came_out(
    page: str,
) -> None:
    headings = re.findall(r"<h2>(.*?)</h2>", page)
    assert headings[:2] == ["What guidance changed", "What it means"]
    assert headings[2:4] == ["What was run", "What came out"]
    assert page.index('id="figure-effects"') < page.index("What it means")


def test_it_says_what_kind_of_drivers_these_are(page: str) -> None:
    assert "These are virtual drivers." in page
    assert "prediction" in page
    assert "scripted" in page
    assert "no subjective workload" in page


@pytest.mark.slow  # a report of its own
def test_the_same_folder_gives_the_same_bytes_wherever_it_lies(
    reported: Path, tmp_path: Path
) -> None:
    told: list[str] = []
    shutil.copytree(reported, tmp_path / "elsewhere")
    write_report(tmp_path / "elsewhere", told.append)
    assert contents(tmp_path / "elsewhere") == contents(reported)
    assert (told[0], told[-1]) == ("tests", "report")
    assert len(told) == NUM_STEPS


def test_no_date_and_no_path_is_in_it(reported: Path, page: str) -> None:
    figures = [f.read_text("utf-8") for f in (reported / "figures").iterdir()]
    assert not any("<dc:date>" in text for text in figures)
    assert not any(str(reported.parent) in text for text in (*figures, page))


def measure_differences(
    reported: Path, quantity: Quantity
) -> Iterator[tuple[str, str]]:
    """Level and difference from manual as the page should print it."""
    by_strength = quantity.name in BY_STRENGTH
    for row in rows(reported / "pairs.csv"):
        levels = row["first"] in ("strong", "weak")
        if (row["measure"], row["analysis"]) == (quantity.name, "within") and (
            levels is by_strength and row["second"] == "manual"
        ):
            value = float(row["mean_difference"]) * quantity.factor
            yield row["first"], signed(value, quantity.digits)


@pytest.mark.parametrize("quantity", QUANTITIES, ids=lambda each: each.name)
def test_numbers_of_the_summary_are_those_of_the_tables(
    reported: Path, page: str, quantity: Quantity
) -> None:
    text = summary(page)[quantity.title]
    manual = next(
        row
        for row in rows(reported / "summaries.csv")
        if (row["measure"], row["analysis"], row["level"])
        == (quantity.name, "within", "manual")
    )
    mean = number(float(manual["mean"]) * quantity.factor, quantity.digits)
    assert text.startswith(f"{mean} {quantity.unit} in manual driving.")
    measures = {line[0].split("\n")[0]: line for line in tables(page)["measures"]}
    assert measures[quantity.title][1].split("\n")[0] == mean
    told = set(re.findall(r"[+−]\d+\.\d+", text))
    pairs = tables(page)[f"pairs-{quantity.name.replace('_', '-')}"]
    printed = {line[0]: line[5].split("\n")[0] for line in pairs}
    expected = dict(measure_differences(reported, quantity))
    assert {level: printed[f"{level} − manual"] for level in expected} == expected
    assert told <= set(expected.values())


def test_lane_changes_achieved_are_those_of_the_table(
    reported: Path, page: str
) -> None:
    trials = rows(reported / "trials.csv")
    completed = sum(int(float(row["num_lane_changes"])) for row in trials)
    assert completed == len(rows(reported / "lane_changes.csv"))
    last = tables(page)["lane-changes"][-1]
    assert last[:4] == ["all", "21", "42", str(completed)]
    assert f"Of 42 planned lane changes {completed} were completed" in page


def test_triggers_told_are_those_of_the_table(reported: Path, page: str) -> None:
    trials = rows(reported / "trials.csv")
    false = sum(int(float(row["num_false_triggers"])) for row in trials)
    shown = [int(line[4]) for line in tables(page)["detection"]]
    assert sum(shown) == false
    assert f"{false} false trigger" in summary(page)["Intention"]


def test_inconsistencies_told_are_those_of_the_table(reported: Path, page: str) -> None:
    trials = [
        row for row in rows(reported / "trials.csv") if row["condition"] != "manual"
    ]
    amount = sum(int(float(row["num_inconsistencies"])) for row in trials)
    assert summary(page)["Inconsistencies"].startswith(
        f"{amount} inconsistencies in 18"
    )
    assert sum(int(line[1]) for line in tables(page)["inconsistencies"]) == amount


def test_all_tests_and_pairs_are_in_the_page(reported: Path, page: str) -> None:
    found = tables(page)
    effects = {(row["measure"], row["effect"]) for row in rows(reported / "tests.csv")}
    assert len(found["effects"]) == len(effects)
    pairs = {
        (row["measure"], row["first"], row["second"])
        for row in rows(reported / "pairs.csv")
    }
    assert sum(len(v) for k, v in found.items() if k.startswith("pairs-")) == len(pairs)


def test_every_trial_is_in_the_page(reported: Path, page: str) -> None:
    wanted = [
        (row["participant"], row["condition"]) for row in rows(reported / "trials.csv")
    ]
    assert [tuple(line[:2]) for line in tables(page)["trials"]] == wanted


def test_settings_versions_and_thresholds_are_in_the_page(
    page: str, material: StudyMaterial
) -> None:
    settings = dict(tuple(line) for line in tables(page)["settings"])
    assert settings["configuration_hash"] == material.study.hash
    assert settings["seed"] == "1"
    assert settings["inconsistency_threshold"]
    records = dict(tuple(line) for line in tables(page)["records"])
    assert records["git_revision"] == "unknown"
    assert {"costeer", "Python", "numpy"} <= {
        line[0] for line in tables(page)["versions"]
    }


def test_it_says_where_single_conditions_are_compared(page: str) -> None:
    assert "SDLP and reversal rate are compared by strength" in page


def test_it_says_which_crossings_have_no_costs(page: str) -> None:
    assert "A crossing that became no completed lane change has no costs" in page
