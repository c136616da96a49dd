"""`costeer report` makes everything of a study again but its records."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from costeer.cli import main
from costeer.records.record import read_record, write_record
from costeer.study.configuration import StudySettings
from costeer.study.locks import locked
from costeer.study.material import find_records
from costeer.study.run import run_study
from tests.study.fakes import contents, made_up

TINY = StudySettings(
    participants=1,
    conditions=("manual", "weak-gentle", "weak-rapid"),
    intention="scripted",
    length=1800.0,
)


@pytest.fixture(scope="module")
def simulated(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A study with its tables."""
    folder = tmp_path_factory.mktemp("simulated") / "study"
    run_study(folder, TINY, jobs=1, report=None, simulate=made_up)
    return folder


@pytest.fixture(scope="module")
def whole(simulated: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The same with its report."""
    folder = shutil.copytree(simulated, tmp_path_factory.mktemp("whole") / "study")
    run_study(folder, TINY, jobs=1, simulate=made_up)
    return folder


@pytest.fixture
def bare(simulated: Path, tmp_path: Path) -> Path:
    """The same with nothing but settings and records."""
    (tmp_path / "study").mkdir()
    shutil.copy(simulated / "study.yaml", tmp_path / "study")
    shutil.copytree(simulated / "records", tmp_path / "study" / "records")
    return tmp_path / "study"


@pytest.mark.slow
def test_records_alone_bring_back_every_byte(
    whole: Path, bare: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["report", str(bare)]) == 0
    assert contents(bare) == contents(whole)
    shown = capsys.readouterr()
    assert shown.out == f"{bare / 'report.html'}\n"
    assert "report: " in shown.err
    assert "without" not in shown.err  # nothing is lacking


@pytest.mark.slow
def test_half_written_and_missing_records_are_named_and_not_believed(
    bare: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    record = bare / "records" / "01-manual.parquet"
    record.write_bytes(record.read_bytes()[:1000])
    (bare / "records" / "01-weak-gentle.parquet").unlink()
    assert main(["report", str(bare)]) == 0
    told = capsys.readouterr().err
    assert "records/01-manual.parquet (damaged or of another study)" in told
    assert "01-weak-gentle.parquet (missing)" in told
    page = (bare / "report.html").read_text("utf-8")
    assert "not complete: 1 of 3 trials are there" in page


@pytest.mark.slow  # a report of its own
def test_answers_of_people_are_kept(whole: Path, tmp_path: Path) -> None:
    folder = tmp_path / "people"
    shutil.copytree(whole, folder)
    for path in find_records(folder).values():
        record = read_record(path)
        metadata = {**record.metadata, "driver_kind": "person"}
        write_record(path, record._replace(metadata=metadata))
    header, *rows = (folder / "trials.csv").read_text("utf-8").splitlines()
    text = "\n".join([f"{header},tlx_raw", *(f"{row},55" for row in rows)])
    (folder / "trials.csv").write_text(text, encoding="utf-8")
    assert main(["report", str(folder)]) == 0
    assert (folder / "trials.csv").read_text("utf-8") == text
    assert (folder / "figures" / "tlx-raw.svg").exists()


@pytest.mark.parametrize(
    ("name", "reason"),
    [("", "not a study folder: it has no study.yaml"), ("none", "not a study folder")],
)
def test_a_folder_that_is_no_study_is_refused_in_one_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], name: str, reason: str
) -> None:
    assert main(["report", str(tmp_path / name)]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert reason in line


def test_a_study_that_is_running_is_left_alone(
    bare: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    with locked(bare):
        assert main(["report", str(bare)]) == 2
    assert "in use by another costeer" in capsys.readouterr().err


def test_one_figure_is_written_and_nothing_else(
    simulated: Path, tmp_path: Path
) -> None:
    before = contents(simulated)
    out = tmp_path / "speed.PDF"
    wanted = ["--figure", "driver-torque-rms", "--width", "8.8cm", "--out", str(out)]
    assert main(["report", str(simulated), *wanted]) == 0
    assert out.read_bytes().startswith(b"%PDF")
    assert contents(simulated) == before


def test_the_data_of_a_figure_are_written_beside_it(
    bare: Path, simulated: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for name in ("trials.csv", "lane_changes.csv", "triggers.csv"):
        shutil.copy(simulated / name, bare)
    assert main(["report", str(bare), "--figure", "sdlp", "--format", "csv"]) == 0
    file = bare / "figures" / "sdlp.csv"
    assert capsys.readouterr().out == f"{file}\n"
    assert "strong" not in file.read_text("utf-8")  # weak alone was driven
    assert "weak-gentle" in file.read_text("utf-8")


@pytest.mark.parametrize(
    ("options", "told"),
    [
        (["--figure", "sdpl"], "no figure 'sdpl' (did you mean sdlp?)"),
        (["--figure", "qqq"], "choose from effects, sdlp"),
        (["--figure", "driver_torque"], "did you mean driver-torque-rms"),
        (["--figure", "agreement"], "nothing to draw figure agreement from"),
        (["--figure", "tlx-raw"], "asked of people only"),
        (
            ["--figure", "sdlp", "--width", "20mm"],
            "--width is 20 mm; give 60 to 210 mm",
        ),
        (["--figure", "sdlp", "--width", "nan"], "--width is no number"),
        (["--figure", "sdlp", "--width", "wide"], "'wide' is not a width"),
        (["--figure", "sdlp", "--format", "eps"], "choose from pdf, png, svg, csv"),
        (["--figure", "sdlp", "--out", "a.doc"], "no format 'doc'"),
        (["--figure", "sdlp", "--format", "pdf", "--out", "a.png"], "ends in .png"),
        (["--figure", "sdlp", "--format", "csv", "--width", "88"], "have no width"),
        (["--figure", "signals-weak", "--width", "60"], "not legible at 60 mm"),
        (["--width", "88mm"], "--width belongs to --figure"),
    ],
)
def test_a_figure_that_cannot_be_is_refused_in_one_line(
    simulated: Path,
    capsys: pytest.CaptureFixture[str],
    options: list[str],
    told: str,
) -> None:
    assert main(["report", str(simulated), *options]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert told in line
