"""`costeer drivers` lists, validates, plots, fits, and tells δ of the pilots."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from costeer.cli import driver_fit, main
from costeer.cli.reading import AS_FOUND
from costeer.drivers.population import POPULATION_VERSION
from costeer.loop.scenario import PILOT_SEED


def drivers(*options: str) -> int:
    return main(["drivers", *options])


def test_without_flags_it_lists_what_differs(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert drivers("--participants", "5", "--seed", "4") == 0
    shown = capsys.readouterr().out
    assert "5 virtual drivers, seed 4" in shown
    assert "arm.stiffness" in shown
    assert "stiffness +0.60" in shown  # what goes together
    assert f"population {POPULATION_VERSION} (virtual)" in shown


def test_another_population_is_listed_by_its_name(
    capsys: pytest.CaptureFixture[str],
) -> None:
    few = ("--participants", "5", "--json")
    durations = {}
    for name, version, domain in (
        ("virtual", "3", "simulator"),
        ("virtual-traffic", "3", "traffic"),
        ("virtual-2", "2", "traffic"),
    ):
        assert drivers(*few, "--population", name) == 0
        told = json.loads(capsys.readouterr().out)
        assert (told["population"], told["name"]) == (version, name)
        assert told["domain"] == domain
        durations[name] = [d["decision.change_duration"] for d in told["drivers"]]
    assert durations["virtual-traffic"] == durations["virtual-2"]
    assert sum(durations["virtual"]) < sum(durations["virtual-traffic"])
    assert drivers("--participants", "2", "--population", "virtual-2") == 0
    shown = capsys.readouterr().out
    assert "population 2 (virtual-2)" in shown
    assert "tolerance.band" not in shown


def test_a_validation_of_another_population_has_the_ranges_of_its_domain(
    capsys: pytest.CaptureFixture[str],
) -> None:
    asked = ("--validate", "--participants", "1", "--population", "virtual-traffic")
    assert drivers(*asked) == 0
    shown = capsys.readouterr().out
    assert "population 3 (virtual-traffic), domain traffic" in shown
    assert "5 to 6.3" in shown
    assert "4.6 to 5.6" not in shown


@pytest.mark.slow
def test_without_validation_the_plot_is_of_the_population(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    plot = tmp_path / "new" / "population.svg"
    assert drivers("--participants", "4", "--plot", str(plot)) == 0
    assert "Histograms of the" in plot.read_text(encoding="utf-8")
    assert "manual trials" not in capsys.readouterr().err


def test_json_lists_each_driver(capsys: pytest.CaptureFixture[str]) -> None:
    assert drivers("--participants", "3", "--json") == 0
    told = json.loads(capsys.readouterr().out)
    assert [driver["participant"] for driver in told["drivers"]] == [1, 2, 3]
    assert told["population"] == POPULATION_VERSION
    assert (told["name"], told["domain"]) == ("virtual", "simulator")
    strongest = told["correlations"][0]
    assert strongest["first"] == "arm_damping"
    assert strongest["correlation"] == pytest.approx(0.42)


@pytest.mark.slow
def test_validation_prints_every_target_and_draws(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    plot = tmp_path / "new" / "drivers.svg"
    few = ("--participants", "2", "--jobs", "2")
    assert drivers("--validate", *few, "--plot", str(plot)) == 0
    shown = capsys.readouterr().out
    assert [f"M{n} " in shown for n in range(1, 13)] == [True] * 12
    assert "of 12 targets met" in shown
    assert "lane-change duration (yaw 0.5 deg), 50 % [s]" in shown
    assert "Manual driving of 2 virtual" in plot.read_text(encoding="utf-8")


def report(folder: Path, participants: int, jobs: int) -> int:
    asked = ("--validate", "--participants", str(participants), "--seed", "3")
    return drivers(*asked, "--jobs", str(jobs), "--out", str(folder))


@pytest.mark.slow  # the whole validation, if of one driver
def test_a_report_tells_its_progress_and_prints_the_targets(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.delenv("COSTEER_DATA", raising=False)
    assert report(tmp_path, 1, 2) == 0
    told = capsys.readouterr()
    assert "of 12 targets met" in told.out
    for stage in ("manual trials", "corrections", "arms", "wrong", "stability"):
        assert stage in told.err
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert "1 virtual driver, population" in page
    assert "Recordings of people were not there" in page
    assert {"real.csv", "targets.csv", "figures"} <= {
        p.name for p in tmp_path.iterdir()
    }


@pytest.mark.slow
def test_a_report_is_the_same_whatever_the_number_of_jobs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("COSTEER_DATA", raising=False)
    one, two = (tmp_path / name for name in ("one", "two"))
    assert report(one, 4, 1) == report(two, 4, 2) == 0
    files = [file for file in one.rglob("*") if file.is_file()]
    assert len(files) > 10
    for file in files:
        assert (two / file.relative_to(one)).read_bytes() == file.read_bytes()


def test_a_fit_is_left_to_its_own_command(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    asked: list[object] = []
    monkeypatch.setattr(driver_fit, "show_fit", lambda *given: asked.append(given))
    file, plot = tmp_path / "trial.parquet", tmp_path / "fit.svg"
    words = ("--fit", str(file), "--json", "--jobs", "3", "--plot", str(plot))
    assert drivers(*words) == 0
    assert asked == [(file, True, 3, plot, None, None, AS_FOUND)]


def test_json_of_a_validation_has_no_nan(capsys: pytest.CaptureFixture[str]) -> None:
    assert drivers("--validate", "--participants", "1", "--json") == 0
    told = json.loads(capsys.readouterr().out)
    by_name = {target["name"]: target for target in told["targets"]}
    assert by_name["M1"]["value"] > 0.0
    assert by_name["M2"]["value"] is None  # one driver has no spread
    assert by_name["M2"]["met"] is False


def test_the_threshold_comes_from_pilot_drivers(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert drivers("--threshold", "--participants", "1", "--json") == 0
    told = json.loads(capsys.readouterr().out)
    assert told["seed"] == PILOT_SEED
    assert told["threshold"] == pytest.approx(2.0 * told["percentile"])
    assert drivers("--threshold", "--participants", "1") == 0
    assert "threshold, twice that" in capsys.readouterr().out


REFUSED = {
    "have a seed of their own": ("--threshold", "--seed", "3"),
    "leave --seed and --speed out": ("--fit", "x", "--seed", "3", "--speed", "20"),
    "--threshold and --validate are different tasks": ("--threshold", "--validate"),
    "leave --out out, or add --fit or --validate": ("--out", "report"),
    "at 70 km/h against people; leave --speed out": ("--validate", "--speed", "20"),
    "--data is for the report; add --out DIR": ("--validate", "--data", "people"),
    "folder 'nowhere' is no folder": (
        *("--validate", "--data", "nowhere", "--out", "report"),
    ),
    "name that ends in .svg": ("--plot", "drivers.png"),
    "0 is not allowed; give from 1": ("--participants", "0"),
    "-1 is not allowed; give at least 0": ("--seed", "-1"),
    "'virtual-trafic' is not known (did you mean virtual-traffic": (
        *("--population", "virtual-trafic"),
    ),
    "population 'people' is not known": ("--validate", "--population", "people"),
    "leave --population out": ("--threshold", "--population", "virtual-2"),
    "speed is 100 m/s (360 km/h); give a number from 12": ("--speed", "100"),
}


@pytest.mark.parametrize("message", REFUSED)
def test_bad_input_is_refused_in_one_line(
    message: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    assert drivers(*REFUSED[message]) == 2
    told = capsys.readouterr().err
    assert message in told
    assert told.count("\n") == 1
    assert list(tmp_path.iterdir()) == []


def test_a_figure_that_cannot_be_written_is_refused_before_driving(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "file").write_text("")
    plot = str(tmp_path / "file" / "drivers.svg")
    assert drivers("--validate", "--plot", plot) == 2
    told = capsys.readouterr().err
    assert "choose a file that you may write" in told
    assert "manual trials" not in told
