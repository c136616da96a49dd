"""`costeer train --adapt`: from a folder of people to weights with a threshold."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from costeer.cli import main
from costeer.intention.features import NUM_FEATURES
from costeer.intention.gru import random_weights
from costeer.intention.weights import intention_network, load_weights, save_weights
from costeer.training.thresholds import with_threshold
from tests.training.synthetic import columns

pytestmark = pytest.mark.usefixtures("few_resamplings")


def lab(folder: Path, num_drivers: int = 6, num_changes: int = 5) -> Path:
    """A folder with a table for each driver, 2 min each."""
    folder.mkdir(parents=True)
    for driver in range(num_drivers):
        drive = pd.DataFrame(columns(driver, num_changes=num_changes))
        drive.assign(participant=driver).to_csv(folder / f"{driver}.csv", index=False)
    return folder


def saved(path: Path, dispensable: float = 1.0, threshold: float | None = None) -> Path:
    """Untrained weights."""
    weights = random_weights(2, 1)._replace(
        dispensable=np.full(NUM_FEATURES, dispensable)
    )
    facts = {} if threshold is None else {"threshold": threshold}
    save_weights(path, intention_network(weights, facts))
    return path


def adapt(*arguments: object) -> int:
    return main(["train", "--adapt", *map(str, arguments)])


def refusal(capsys: pytest.CaptureFixture[str]) -> str:
    """The one line on stderr."""
    (line,) = capsys.readouterr().err.strip().splitlines()
    return line


@pytest.mark.slow  # 7 networks of 11 min of driving
def test_a_lab_gets_weights_with_facts_and_a_threshold_that_is_used(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder, out = lab(tmp_path / "lab"), tmp_path / "ours.npz"
    start = saved(tmp_path / "start.npz")
    words = ("--start", start, "--steps", 0, "--out", out, "--false-per-km", 5)
    assert adapt(folder, *words) == 0
    shown = capsys.readouterr()
    assert "Judged on drivers left out: 6" in shown.out
    assert "for 5 false triggers per km" in shown.err
    facts = load_weights(out).facts
    assert facts["start"]["hash"] == load_weights(start).hash
    assert facts["data"]["set"] == "0.csv, 1.csv, 2.csv, 3.csv, 4.csv, 5.csv"
    assert facts["data"]["version"].startswith("sha256:")
    assert facts["adapted_to"]["lane_changes"] == 30
    assert (
        main(["evaluate", str(folder / "0.csv"), "--weights", str(out), "--json"]) == 0
    )
    assert json.loads(capsys.readouterr().out)["threshold"] == facts["threshold"]
    again = tmp_path / "again.npz"
    assert adapt(folder, *words[:-4], "--out", again, "--false-per-km", 5) == 0
    assert again.read_bytes() == out.read_bytes()


def test_weights_bring_their_threshold_into_a_trial(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    weights, out = saved(tmp_path / "w.npz", threshold=0.25), tmp_path / "t.parquet"
    words = [
        "simulate",
        "--out",
        str(out),
        "--length",
        "100",
        "--weights",
        str(weights),
    ]
    assert main(words) == 0
    assert "inference.threshold is 0.25" in capsys.readouterr().err
    assert main([*words, "--set", "inference.threshold=0.6"]) == 0
    assert "inference.threshold" not in capsys.readouterr().err
    assert with_threshold({}, "gru", weights, "lane-keeping") == {}  # has none
    assert with_threshold({}, "gru", saved(tmp_path / "plain.npz")) == {}


def no_folder(folder: Path) -> tuple[object, ...]:
    return (folder / "nowhere",)


def empty(folder: Path) -> tuple[object, ...]:
    (folder / "empty").mkdir()
    return (folder / "empty",)


def short(folder: Path) -> tuple[object, ...]:
    return (lab(folder / "lab", 2, 1),)


def straight(folder: Path) -> tuple[object, ...]:
    place = lab(folder / "lab", 1, 32)
    drive = pd.read_csv(place / "0.csv")
    drive.assign(lane=1).to_csv(place / "0.csv", index=False)
    return (place,)


def no_start(folder: Path) -> tuple[object, ...]:
    return (lab(folder / "lab", 1, 1), "--start", folder / "none.npz")


def other_start(folder: Path) -> tuple[object, ...]:
    place = lab(folder / "lab", 1, 1)
    return (place, "--start", place / "0.csv")


def needy_start(folder: Path) -> tuple[object, ...]:
    place = lab(folder / "lab", 1, 1)
    blind = pd.read_csv(place / "0.csv").drop(columns="head_yaw")
    blind.to_csv(place / "0.csv", index=False)
    return (place, "--start", saved(folder / "w.npz", dispensable=0.0))


def with_files(folder: Path) -> tuple[object, ...]:
    return (folder, "--simulate", "3")


def no_rate(folder: Path) -> tuple[object, ...]:
    return (folder, "--false-per-km", "0")


@pytest.mark.parametrize(
    ("given", "said"),
    [
        (no_folder, "nowhere is no folder; give one that holds recordings"),
        (empty, "holds no table; their names end in .csv"),
        (short, "hold 1.1 min with verdicts (the longest is 35 s; the first 180"),
        (
            straight,
            "hold 0 lane changes after 3 s of driving; adapting needs at least 4",
        ),
        (no_start, "none.npz is no file; give shipped or a FILE.npz"),
        (other_start, "0.csv is not a file of intention weights"),
        (needy_start, "was not trained to do without head_yaw"),
        (with_files, "leave out --simulate"),
        (no_rate, "0"),
    ],
)
def test_what_cannot_be_is_named_with_the_way_out(
    given: Callable[[Path], tuple[object, ...]],
    said: str,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert adapt(*given(tmp_path), "--out", tmp_path / "out.npz") == 2
    shown = [
        line
        for line in capsys.readouterr().err.strip().splitlines()
        if not line.startswith("note")
    ]
    assert len(shown) == 1
    assert said in shown[0]
    assert not (tmp_path / "out.npz").exists()


@pytest.mark.parametrize("words", [("--steps", "0"), ("--false-per-km", "1")])
def test_options_of_an_adaptation_are_refused_elsewhere(
    words: tuple[str, str], capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["train", "--simulate", "3", *words]) == 2
    assert "are for --adapt FOLDER" in refusal(capsys)
