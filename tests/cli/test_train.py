"""`costeer train` and `costeer evaluate`: from tables to a judged network."""

from __future__ import annotations

import json
from pathlib import Path

import pandas as pd
import pytest

from costeer.cli import main
from costeer.intention.gru import hidden_size
from costeer.intention.weights import load_weights
from tests.training.synthetic import columns

pytestmark = pytest.mark.usefixtures("few_resamplings")


def table(path: Path, num_drivers: int = 3, without: str = "") -> Path:
    """Short drives of several participants in one CSV."""
    parts = []
    for driver in range(num_drivers):
        part = pd.DataFrame(columns(driver, num_changes=1))
        parts.append(part.assign(sequence=driver, participant=driver))
    pd.concat(parts).drop(columns=without or []).to_csv(path, index=False)
    return path


def train(*arguments: object) -> int:
    return main(["train", *map(str, arguments), "--steps", "2", "--hidden", "3"])


@pytest.fixture(scope="module")
def weights(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("train")
    out = folder / "new" / "network.npz"
    assert train(table(folder / "drives.csv"), "--out", out) == 0
    return out


def test_training_leaves_a_network_with_its_facts(weights: Path) -> None:
    network = load_weights(weights)
    assert hidden_size(network.weights) == 3
    assert network.facts["source"] == "files drives.csv"
    assert network.facts["test"]["num_drivers"] == 1
    assert [file.name for file in weights.parent.iterdir()] == [weights.name]


@pytest.mark.slow  # a training of its own
def test_the_same_command_gives_the_same_bytes(weights: Path, tmp_path: Path) -> None:
    source = table(tmp_path / "drives.csv")
    assert train(source, "--out", tmp_path / "again.npz") == 0
    assert (tmp_path / "again.npz").read_bytes() == weights.read_bytes()


def test_a_table_is_judged_in_words_and_in_json(
    weights: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ["evaluate", str(table(tmp_path / "d.csv")), "--weights", str(weights)]
    assert main(words) == 0
    shown = capsys.readouterr().out
    assert 'accuracy of the answer "never"' in shown
    assert "3 drivers" in shown
    assert main([*words, "--json", "--threshold", "0.3"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["threshold"] == 0.3
    assert found["intention_model_hash"] == load_weights(weights).hash
    assert found["samples"]["accuracy_of_never"] < 1.0


def test_one_driver_gives_counts_and_no_interval(
    weights: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    source = table(tmp_path / "d.csv", num_drivers=1)
    assert main(["evaluate", str(source), "--weights", str(weights)]) == 0
    shown = capsys.readouterr().out
    assert "1 driver, " in shown
    assert (
        " to " not in shown.split("accuracy of the answer", 1)[1].split("early", 1)[0]
    )
    (false,) = [line for line in shown.splitlines() if "│ false triggers   " in line]
    assert false.split("│")[2].strip().isdigit()


def test_degrees_are_pointed_out(
    weights: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    source = table(tmp_path / "d.csv")
    wrong = pd.read_csv(source)
    wrong["longitudinal_velocity"] *= 3.6 * 3.0
    wrong.to_csv(source, index=False)
    assert main(["evaluate", str(source), "--weights", str(weights)]) == 0
    (note,) = capsys.readouterr().err.splitlines()  # once for the file
    assert "longitudinal_velocity looks like km/h, expected m/s" in note


def refusal(capsys: pytest.CaptureFixture[str]) -> str:
    """The one line on stderr."""
    (line,) = capsys.readouterr().err.strip().splitlines()
    return line


def test_a_missing_input_is_named_with_the_variant_that_speaks(
    weights: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    source = table(tmp_path / "d.csv", without="head_yaw")
    assert main(["evaluate", str(source), "--weights", str(weights)]) == 0
    (note,) = capsys.readouterr().err.splitlines()
    assert "lack head_yaw" in note
    assert "variant 'no-head'" in note


def test_a_wrong_file_of_weights_is_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    source = table(tmp_path / "d.csv")
    assert main(["evaluate", str(source), "--weights", str(source)]) == 2
    assert "not a file of intention weights" in refusal(capsys)


def test_nothing_to_learn_from_is_said(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["train"]) == 2
    assert "--simulate 60" in refusal(capsys)


def test_too_few_drivers_are_said(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    source = table(tmp_path / "d.csv", num_drivers=2)
    assert train(source, "--out", tmp_path / "w.npz") == 2
    assert "at least 3" in refusal(capsys)


def test_an_output_that_is_a_folder_is_refused_before_training(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["train", "--simulate", "3", "--out", str(tmp_path)]) == 2
    assert f"--out {tmp_path} cannot become" in refusal(capsys)


def test_another_file_is_never_replaced_by_weights(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    thesis, device = tmp_path / "thesis.tex", tmp_path / "device.npz"
    thesis.write_text("years")
    device.symlink_to("/dev/null")
    for out in (thesis, device):
        assert main(["train", "--simulate", "3", "--out", str(out)]) == 2
        assert "give a file's name that ends in .npz" in refusal(capsys)
    assert thesis.read_text() == "years"
    assert device.is_symlink()


@pytest.mark.parametrize(
    "option",
    [
        ("--simulate", "-1"),
        ("--simulate", "2"),
        ("--simulate", "99999999"),
        ("--hidden", "0"),
        ("--seed", "-1"),
    ],
)
def test_impossible_numbers_are_refused(
    option: tuple[str, str], capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["train", *option]) == 2
    assert option[1] in refusal(capsys)


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("--dataset", "ngsim_lc"), "--dataset and --data go together"),
        (("--data", "data"), "nothing to learn from"),
        (("--fit", "everything", "--simulate", "3"), "everything"),
        (("--fit", "baselines", "--simulate", "3", "--hidden", "8"), "--hidden"),
        (("--start", "w.npz", "--simulate", "3", "--hidden", "8"), "--hidden"),
        (("--dataset", "no", "--data", "."), "there is no set 'no'"),
    ],
)
def test_options_that_do_not_go_together_are_told(
    words: tuple[str, ...], said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["train", *words]) == 2
    assert said in refusal(capsys)


@pytest.mark.slow
def test_a_network_goes_on_learning_from_a_table(weights: Path, tmp_path: Path) -> None:
    source, out = table(tmp_path / "d.csv"), tmp_path / "tuned.npz"
    words = ["train", str(source), "--start", str(weights), "--out", str(out)]
    assert main([*words, "--steps", "2"]) == 0
    tuned, start = load_weights(out), load_weights(weights)
    assert tuned.facts["start"]["hash"] == start.hash
    assert tuned.hash != start.hash
    assert tuned.facts["drivers"]["training"] == ["0", "1", "2"]
