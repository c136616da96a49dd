"""A folder belongs to one study, and one process works in it at a time."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest
import yaml

from costeer.base.files import write_text
from costeer.study.folder import (
    STUDY_FILE,
    configuration_hash,
    opened_study,
    read_study,
    record_path,
)
from costeer.study.locks import LOCK_FILE, locked

CONFIGURATION: dict[str, object] = {"seed": 1, "speed": 70 / 3.6, "order": [["manual"]]}
HOLD = """
import sys, time
from pathlib import Path
from costeer.study.locks import locked
with locked(Path(sys.argv[1])):
    print("held", flush=True)
    time.sleep(60)
"""


def begin(path: Path, configuration: dict[str, object] = CONFIGURATION) -> None:
    with opened_study(path, configuration, "costeer study"):
        pass


def holder_of(path: Path) -> subprocess.Popen[str]:
    """A process that holds the folder."""
    command = [sys.executable, "-c", HOLD, str(path)]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    assert process.stdout is not None
    assert process.stdout.readline() == "held\n"
    return process


def test_what_was_begun_can_be_read(tmp_path: Path) -> None:
    begin(tmp_path / "new" / "study")
    study = read_study(tmp_path / "new" / "study")
    assert study.configuration == CONFIGURATION
    assert len(study.hash) == 64


def test_a_new_folder_holds_the_command_and_a_place_for_records(tmp_path: Path) -> None:
    begin(tmp_path)
    assert sorted(p.name for p in tmp_path.iterdir()) == ["records", STUDY_FILE]
    text = (tmp_path / STUDY_FILE).read_text(encoding="utf-8")
    assert "#   costeer study\n" in text


def test_record_names_sort_by_participant(tmp_path: Path) -> None:
    path = record_path(tmp_path, 3, "weak-gentle")
    assert path == tmp_path / "records" / "03-weak-gentle.parquet"


def test_the_same_study_is_opened_again_unchanged(tmp_path: Path) -> None:
    begin(tmp_path)
    before = (tmp_path / STUDY_FILE).read_bytes()
    begin(tmp_path)
    assert (tmp_path / STUDY_FILE).read_bytes() == before


def test_another_study_is_refused_and_told_apart(tmp_path: Path) -> None:
    begin(tmp_path)
    with pytest.raises(ValueError, match=r"seed is 1 there, 2 here.*another folder"):
        begin(tmp_path, {**CONFIGURATION, "seed": 2})


def test_other_sources_are_told_without_their_hashes(tmp_path: Path) -> None:
    begin(tmp_path, {**CONFIGURATION, "simulation_source": "a"})
    with pytest.raises(ValueError, match="simulated by other sources of costeer"):
        begin(tmp_path, {**CONFIGURATION, "simulation_source": "b"})


@pytest.mark.parametrize(
    ("there", "here", "told"),
    [
        ({"predictor": "gru"}, {"predictor": "gap"}, "predictor is gru there, gap h"),
        ({"weights": ""}, {"weights": "a.npz"}, "weights is  there, a.npz here"),
        ({"drivers": []}, {"drivers": ["a.yaml"]}, "drivers is"),
        (
            {"parameters": {"guidance.gain": 2.0}},
            {"parameters": {"guidance.gain": 3.0, "car.mass": 9.0}},
            "car.mass is as usual there, 9.0 here; guidance.gain is 2.0 there, 3.0",
        ),
        ({"method_version": "1"}, {"method_version": "2"}, "has another version"),
        (
            {"method_source_hash": "a"},
            {"method_source_hash": "b"},
            "the code of the method was edited",
        ),
        (
            {"intention_model_hash": "a"},
            {"intention_model_hash": "b"},
            "the predictor's code or numbers were changed",
        ),
        (
            {"car_parameters": {"mass": 1.0, "width": 2.0}},
            {"car_parameters": {"mass": 3.0, "width": 2.0}},
            "another study: car.mass is 1.0 there, 3.0 here. Choose",
        ),
        (
            {"driver_parameters": [{"arm.inertia": 1.0}, {"arm.inertia": 2.0}]},
            {"driver_parameters": [{"arm.inertia": 1.0}, {"arm.inertia": 3.0}]},
            "another study: driver 2: arm.inertia is 2.0 there, 3.0 here. Choose",
        ),
    ],
)
def test_what_a_user_chose_is_named_and_nothing_is_to_be_removed(
    tmp_path: Path, there: dict[str, object], here: dict[str, object], told: str
) -> None:
    begin(tmp_path, {**CONFIGURATION, **there})
    with pytest.raises(ValueError, match="holds another study") as refused:
        begin(tmp_path, {**CONFIGURATION, **here})
    assert told in str(refused.value)
    assert "remove" not in str(refused.value)


def test_code_that_changed_with_costeer_is_of_another_version(tmp_path: Path) -> None:
    old = {"simulation_source": "a", "method_source_hash": "a"}
    new = {"simulation_source": "b", "method_source_hash": "b"}
    begin(tmp_path, {**CONFIGURATION, **old})
    with pytest.raises(ValueError, match="holds a study of another version"):
        begin(tmp_path, {**CONFIGURATION, **new})


def test_a_study_of_another_version_asks_for_no_options(tmp_path: Path) -> None:
    begin(tmp_path, {**CONFIGURATION, "inconsistency_threshold": 0.036})
    with pytest.raises(
        ValueError, match=r"another version of costeer: .*0\.036 there.*remove this"
    ) as refused:
        begin(tmp_path, {**CONFIGURATION, "inconsistency_threshold": 0.035})
    assert "options" not in str(refused.value)


def test_a_folder_of_other_things_is_refused(tmp_path: Path) -> None:
    (tmp_path / "thesis.tmp").write_text("years")
    with pytest.raises(ValueError, match=r"no study \(it holds thesis"):
        begin(tmp_path)


def test_leftovers_of_a_killed_process_are_removed(tmp_path: Path) -> None:
    begin(tmp_path)
    for name in ("records/01-manual.parquet.tmp", "trials.csv.tmp"):
        (tmp_path / name).write_text("half")
    begin(tmp_path)
    assert not list(tmp_path.rglob("*.tmp"))


def test_killed_before_the_study_was_written_is_a_new_folder(tmp_path: Path) -> None:
    (tmp_path / LOCK_FILE).write_text("process 1")
    (tmp_path / f"{STUDY_FILE}.tmp").write_text("half")
    begin(tmp_path)
    assert read_study(tmp_path).configuration == CONFIGURATION


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("a: [", "it is not YAML"),
        ("- 1", "it is not YAML of a study"),
        ("format: 99\nconfiguration: {}", "it is not of format 1"),
        ("configuration: 3\nformat: 1", "it is not of format 1"),
        ("format: 1\nconfiguration: {1: a, b: c}", "holds what no study has"),
        ("format: 1\nconfiguration: {a: 2021-03-01}", "holds what no study has"),
        ("format: 1\nconfiguration: {a: .nan}", "holds what no study has"),
        ('a: !!int ""', "it is not YAML"),
        ("a: 2021-13-41", "it is not YAML"),
        ("[" * 1000, "it is not YAML"),
        ("a: &a [*a]", "its references to itself grow too large"),
        (
            "a0: &a0 [x,x,x,x,x,x,x,x,x]\n"
            + "".join(
                f"a{k + 1}: &a{k + 1} [{','.join([f'*a{k}'] * 9)}]\n" for k in range(9)
            ),
            "its references to itself grow too large",
        ),
    ],
)
def test_a_damaged_study_file_is_refused(
    tmp_path: Path, text: str, message: str
) -> None:
    (tmp_path / STUDY_FILE).write_text(text)
    with pytest.raises(ValueError, match=message):
        begin(tmp_path)


def test_an_edited_study_file_is_refused(tmp_path: Path) -> None:
    begin(tmp_path)
    file = tmp_path / STUDY_FILE
    content = yaml.safe_load(file.read_text(encoding="utf-8"))
    content["configuration"]["seed"] = 7
    file.write_text(yaml.safe_dump(content))
    with pytest.raises(ValueError, match="its hash does not fit"):
        read_study(tmp_path)


WRONG_KINDS = [
    ({"seed": "abc"}, "seed is 'abc', not a whole number"),
    ({"seed": True}, "seed is True, not a whole number"),
    ({"participants": [1]}, "participants is [1], not a whole number"),
    ({"participants": 2.5}, "participants is 2.5, not a whole number"),
    ({"length": -5.0}, "length is -5.0, not a number above 0"),
    ({"length": "8 km"}, "length is '8 km', not a number above 0"),
    ({"speed": None}, "speed is None, not a number above 0"),
    ({"conditions": "manual"}, "conditions is 'manual', not a list of texts"),
    ({"conditions": {"manual": 1}}, "conditions is {'manual': 1}, not a list"),
    ({"parameters": ["a"]}, "parameters is ['a'], not numbers by name"),
    ({"parameters": {"a": "b"}}, "parameters is {'a': 'b'}, not numbers by name"),
    ({"drivers": {}}, "drivers is {}, not a list of texts"),
    ({"car": 1}, "car is 1, not a text"),
    ({"order": [1]}, "order is [1], not a list of lists of texts"),
    ({"car_parameters": [1]}, "car_parameters is [1], not numbers by name or null"),
    ({"driver_parameters": {"a": 1}}, "driver_parameters is {'a': 1}, not a list"),
    ({"method": list(range(99))}, "..., not a text"),
]


@pytest.mark.parametrize(("changes", "message"), WRONG_KINDS)
def test_a_setting_of_another_kind_is_named_although_the_hash_fits(
    tmp_path: Path, changes: dict[str, object], message: str
) -> None:
    begin(tmp_path)
    file = tmp_path / STUDY_FILE
    content = yaml.safe_load(file.read_text(encoding="utf-8"))
    content["configuration"] |= changes
    content["configuration_hash"] = configuration_hash(content["configuration"])
    file.write_text(yaml.safe_dump(content))
    for use in (begin, read_study):
        with pytest.raises(ValueError, match=re.escape(message)) as error:
            use(tmp_path)
        assert str(error.value).startswith(f"{file} cannot be used: ")


def test_a_folder_without_a_study_is_not_read(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"not a study folder: it has no study\.yaml"):
        read_study(tmp_path)


def test_a_lock_in_this_process_is_respected(tmp_path: Path) -> None:
    with (
        locked(tmp_path),
        pytest.raises(ValueError, match=r"in use by another costeer \(process \d+"),
    ):
        begin(tmp_path)


def test_a_live_process_keeps_its_folder_and_a_killed_one_does_not(
    tmp_path: Path,
) -> None:
    process = holder_of(tmp_path)
    try:
        with pytest.raises(
            ValueError, match=f"process {process.pid} on .*; wait until"
        ):
            begin(tmp_path)
    finally:
        process.kill()
        process.communicate()
    begin(tmp_path)


def test_the_lock_leaves_nothing_behind(tmp_path: Path) -> None:
    with locked(tmp_path):
        assert (tmp_path / LOCK_FILE).exists()
    assert not list(tmp_path.iterdir())


def test_a_text_that_cannot_be_written_leaves_the_old_one(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    file = tmp_path / "trials.csv"
    write_text(file, "old")

    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Path, "replace", full)
    with pytest.raises(OSError, match="No space left"):
        write_text(file, "new")
    assert [p.name for p in tmp_path.iterdir()] == ["trials.csv"]
    assert file.read_text() == "old"
