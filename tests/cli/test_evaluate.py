"""`costeer evaluate`: where recordings come from, who is judged, what is written."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from costeer.cli import main
from costeer.intention.features import NUM_FEATURES
from costeer.intention.gru import random_weights
from costeer.intention.weights import intention_network, save_weights
from costeer.loop.scenario import TrialSetup
from costeer.training import simulation
from costeer.training.recordings import Recording
from tests.training.synthetic import columns, drives

pytestmark = pytest.mark.usefixtures("few_resamplings")


@pytest.fixture(scope="module")
def source(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Short drives of three participants in one CSV."""
    path = tmp_path_factory.mktemp("evaluate") / "drives.csv"
    parts = [
        pd.DataFrame(columns(k, num_changes=1)).assign(sequence=k, participant=k)
        for k in range(3)
    ]
    pd.concat(parts).to_csv(path, index=False)
    return path


@pytest.fixture(scope="module")
def weights(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A network that does without anything, and knows nothing."""
    path = tmp_path_factory.mktemp("weights") / "network.npz"
    save_weights(path, intention_network(random_weights(2, 1), {}))
    return path


def evaluate(*arguments: object) -> int:
    return main(["evaluate", *map(str, arguments)])


def refusal(capsys: pytest.CaptureFixture[str]) -> str:
    """The last line on stderr."""
    return capsys.readouterr().err.strip().splitlines()[-1]


@pytest.mark.slow
def test_comparison_and_ablations_are_in_words_json_and_a_folder(
    source: Path, weights: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = (source, "--weights", weights, "--compare", "--ablations")
    out = tmp_path / "judged"
    assert evaluate(*words) == 0
    printed = capsys.readouterr().out
    assert "GRU with hidden signals" in printed
    assert "head only" in printed
    assert evaluate(*words, "--json", "--out", out) == 0
    shown = capsys.readouterr()
    assert f"report: {out / 'report.html'}" in shown.err
    found = json.loads(shown.out)
    assert found == json.loads((out / "evaluation.json").read_text())
    assert found["comparison"]["reference"] == "gru"
    names = {one["name"] for one in found["comparison"]["excluded"]}
    assert names | set(found["comparison"]["predictors"]) >= {"gru", "line-time"}
    assert set(found["ablations"]["predictors"]) >= {"full", "no-head", "no-wheel"}


def test_a_signal_that_is_taken_away_is_told_with_the_variant(
    source: Path, weights: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = (source, "--weights", weights, "--json")
    assert evaluate(*words, "--without", "head_yaw") == 0
    shown = capsys.readouterr()
    assert "3 of 3 recordings lack head_yaw; the variant 'no-head'" in shown.err
    assert evaluate(*words) == 0
    whole = json.loads(capsys.readouterr().out)
    assert json.loads(shown.out)["samples"] != whole["samples"]


def test_json_says_which_data_and_how_intervals_were_made(
    source: Path, weights: Path, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    assert evaluate(source, "--weights", weights, "--json") == 0
    found = json.loads(capsys.readouterr().out)
    assert found["data"]["set"] == "files drives.csv"
    assert found["data"]["seed"] is None
    assert found["intervals"]["resamples"] == 1000
    assert found["intervals"]["none_because"].startswith("3 drivers are too few")
    assert found["interval_95"] == {}
    assert {"log_loss"} <= found["samples"].keys()
    other = tmp_path / "drives.csv"
    other.write_text(source.read_text() + "\n")
    assert evaluate(other, "--weights", weights, "--json") == 0
    again = json.loads(capsys.readouterr().out)["data"]
    assert again["set"] == found["data"]["set"]
    assert again["version"] != found["data"]["version"]


def test_an_odd_set_of_signals_is_pointed_out(
    source: Path, weights: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = (source, "--weights", weights, "--without", "yaw_angle")
    assert evaluate(*words) == 0
    assert "not trained to lack just these" in capsys.readouterr().err


def test_a_network_that_needs_the_signal_is_refused(
    source: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    strict = random_weights(2, 1)._replace(dispensable=np.zeros(NUM_FEATURES))
    save_weights(tmp_path / "w.npz", intention_network(strict, {}))
    words = (source, "--weights", tmp_path / "w.npz", "--without", "head_yaw")
    assert evaluate(*words) == 2
    assert "no verdict on any sample" in refusal(capsys)


def test_simulated_drivers_are_judged(
    weights: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[TrialSetup] = []

    def made(setups: Sequence[TrialSetup], *_: object) -> list[Recording]:
        asked.extend(setups)
        return drives(len(setups), num_changes=1)

    monkeypatch.setattr(simulation, "simulate_setups", made)
    words = ("--simulate", 2, "--seed", 4, "--weights", weights, "--json")
    assert evaluate(*words) == 0
    assert json.loads(capsys.readouterr().out)["num_drivers"] == 2
    # Training counts from 100001, studies from 1.
    assert [setup.participant for setup in asked] == [300_001, 300_002]
    assert {(setup.seed, setup.strength_factor) for setup in asked} == {(4, 0.0)}


def test_simulated_drivers_drive_in_a_scenario_and_the_result_says_so(
    weights: Path,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    asked: list[TrialSetup] = []

    def made(setups: Sequence[TrialSetup], *_: object) -> list[Recording]:
        asked.extend(setups)
        return drives(len(setups), num_changes=1)

    monkeypatch.setattr(simulation, "simulate_setups", made)
    file = tmp_path / "short.yaml"
    file.write_text("name: short-way\nspeed: 20\nroad: {length: 900}\n")
    words = ("--simulate", 2, "--weights", weights)
    assert evaluate(*words, "--scenario", file, "--json") == 0
    assert json.loads(capsys.readouterr().out)["scenario"] == "short-way"
    assert {(setup.length, setup.speed) for setup in asked} == {(900.0, 20.0)}
    assert evaluate(*words, "--scenario", file) == 0
    assert "short-way" in capsys.readouterr().out
    # Without one: the published road, as the record of a study has it.
    assert evaluate(*words, "--json") == 0
    assert json.loads(capsys.readouterr().out)["scenario"] == "expressway"
    assert {setup.scenario for setup in asked[-2:]} == {"expressway"}


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        ((), "give --simulate 24"),
        (("x.csv", "--scenario", "obstacle"), "--scenario is of simulated drivers"),
        (("--simulate", "2", "--scenario", "three-lane"), "three-lanes"),
        (("x.csv", "--simulate", "3"), "files and --simulate"),
        (("x.csv", "--seed", "3"), "add --simulate N"),
        (("x.csv", "--data", "."), "add --dataset NAME"),
        (("x.csv", "--predictor", "crystal-ball"), "'crystal-ball'"),
        (("x.csv", "--without", "gaze"), "--without gaze is no signal"),
        (("--simulate", "0"), "from 1 to 10000"),
        (("--simulate", "2", "--seed", "-1"), "at least 0"),
        (("--dataset", "moon", "--data", "."), "'moon'"),
        (("--dataset", "ngsim_lc", "--data", "nowhere"), "'nowhere'"),
        (("x.csv", "--threshold", "1.5"), "from 0 to 1"),
        (("x.csv", "--false-per-km", "0"), "above 0"),
        (("nowhere.csv",), "nowhere.csv"),
    ],
)
def test_what_cannot_be_judged_is_refused_with_the_way_out(
    arguments: tuple[str, ...], told: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert evaluate(*arguments) == 2
    assert told in refusal(capsys)


def test_a_folder_with_other_things_is_refused_before_judging(
    source: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "thesis.tex").write_text("years")
    assert evaluate(source, "--out", tmp_path) == 2
    assert "holds thesis.tex" in refusal(capsys)


@pytest.mark.slow
def test_the_same_command_gives_the_same_bytes(
    source: Path, weights: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = (source, "--weights", weights, "--json")
    assert evaluate(*words) == 0
    first = capsys.readouterr().out
    assert evaluate(*words) == 0
    assert capsys.readouterr().out == first


def test_a_function_in_a_file_is_judged(
    source: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "never.py"
    file.write_text("def PREDICTOR(window):\n    return 0.0\n")
    assert evaluate(source, "--predictor", file, "--json") == 0
    found = json.loads(capsys.readouterr().out)
    assert found["triggers"]["true_triggers"] == 0
    assert evaluate(source, "--predictor", tmp_path / "none.py") == 2
    assert "there is no file" in refusal(capsys)


def as_another_lab(source: Path, folder: Path) -> Path:
    """The drives of the source with other names, units and marks; and its file."""
    drives = pd.read_csv(source)
    drives["yaw_angle"] = -np.degrees(drives["yaw_angle"])
    drives["longitudinal_velocity"] *= 3.6
    names = {"time": "t", "yaw_angle": "heading", "sequence": "run", "crossing": "x"}
    path = folder / "lab.txt"
    drives = drives.rename(columns=names)
    twice = pd.concat([drives[:101], drives[100:]])
    twice.to_csv(path, index=False, sep=";", decimal=",")
    lines = [
        f"names: {{{', '.join(f'{v}: {k}' for k, v in names.items() if v in drives)}}}",
        "units: {yaw_angle: deg, longitudinal_velocity: km/h}",
        "flip: [yaw_angle]",
    ]
    (folder / "lab.yaml").write_text("\n".join(lines))
    return path


@pytest.mark.slow
def test_a_table_of_another_lab_is_judged_as_the_same_drives_in_our_names(
    source: Path, weights: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    other = as_another_lab(source, tmp_path)
    judged = ("--weights", weights, "--json")
    assert evaluate(source, *judged) == 0
    ours = json.loads(capsys.readouterr().out)
    words = (other, "--map", tmp_path / "lab.yaml", "--drop-repeated", *judged)
    assert evaluate(*words) == 0
    shown = capsys.readouterr()
    theirs = json.loads(shown.out)
    assert theirs["samples"]["roc_auc"] == pytest.approx(ours["samples"]["roc_auc"])
    assert theirs["triggers"] == pytest.approx(ours["triggers"])
    assert "read as text with semicolons between columns" in shown.err
    assert "1 rows repeat the time of the row before" in shown.err
    assert evaluate(*words, "--separator", ";", "--decimal", ",") == 0
    assert "read as text with" not in capsys.readouterr().err


def test_what_is_wrong_with_a_table_is_told_at_its_own_rate_too(
    weights: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    drive = columns(1)
    drive["lateral_position"] = np.cumsum(
        drive["longitudinal_velocity"] * drive["yaw_angle"] / 60.0
    )
    drive["yaw_angle"] = -drive["yaw_angle"]
    path = tmp_path / "flipped.csv"
    pd.DataFrame(drive)[::3].to_csv(path, index=False)
    assert evaluate(path, "--weights", weights, "--resample", "--json") == 0
    assert "contradict each other in sign" in capsys.readouterr().err


def test_options_of_tables_without_a_table_are_refused(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert evaluate("--simulate", 2, "--map", "lab.yaml", "--drop-repeated") == 2
    assert "--map and --drop-repeated: this is for tables" in refusal(capsys)
