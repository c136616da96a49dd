"""Where the recordings lie, and what is said when they cannot be read."""

from __future__ import annotations

import gzip
from pathlib import Path

import numpy as np
import pytest

from costeer.validation.people.folder import (
    ENVIRONMENT,
    FILES,
    Columns,
    data_folder,
    groups,
    read_table,
    table_path,
)

TWO = Columns(numbers=("t", "v"), texts=("name",))


def write(path: Path, text: str) -> Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    if path.suffix == ".gz":
        path.write_bytes(gzip.compress(text.encode()))
    else:
        path.write_text(text)
    return path


def test_nothing_named_means_no_recordings(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv(ENVIRONMENT, raising=False)
    assert data_folder() is None
    assert table_path(None, "ngsim_lc") is None


def test_the_argument_goes_before_the_environment(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for place in ("one", "other"):
        write(tmp_path / place / "ngsim_lc" / "sequences.csv", "t\n")
    monkeypatch.setenv(ENVIRONMENT, str(tmp_path / "one"))
    assert data_folder() == tmp_path / "one"
    assert data_folder(tmp_path / "other") == tmp_path / "other"


def test_a_folder_that_is_not_there_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(ENVIRONMENT, str(tmp_path / "nowhere"))
    with pytest.raises(ValueError, match=r"COSTEER_DATA '.*nowhere' is no folder"):
        data_folder()
    with pytest.raises(ValueError, match=r"folder '.*gone' is no folder; name the one"):
        data_folder(tmp_path / "gone")


def test_a_folder_without_any_set_is_refused(tmp_path: Path) -> None:
    (tmp_path / "ngsim_lc").mkdir()
    with pytest.raises(ValueError, match=r"none of the sets; .*ngsim_lc/sequences"):
        data_folder(tmp_path)


@pytest.mark.parametrize("name", FILES)
def test_any_one_set_is_enough(tmp_path: Path, name: str) -> None:
    write(tmp_path / name / FILES[name], "t\n")
    assert data_folder(tmp_path) == tmp_path


@pytest.mark.parametrize("file", ["table.csv", "table.csv.gz"])
def test_a_table_is_read_packed_or_not(tmp_path: Path, file: str) -> None:
    path = write(tmp_path / file, "t,name,more,v\n0.5,a,x,\n1,b,y,-2e3\n\n")
    table = read_table(path, TWO)
    assert set(table) == {"t", "v", "name"}
    assert table["t"].tolist() == [0.5, 1.0]
    assert np.isnan(table["v"][0])
    assert table["v"][1] == -2000.0
    assert table["name"].tolist() == ["a", "b"]


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("t,name\n1,a\n", "has no column v; it has t, name"),
        ("", "has no column t, v, name; it has none"),
        ("t,v,name\n1,2,a\n1,fast,b\n", "holds 'fast' as v in row 3; give a number"),
        ("t,v,name\n1,2\n", "has 2 cells in row 2 and 3 column names"),
    ],
)
def test_what_is_wrong_with_a_table_is_said(
    tmp_path: Path, text: str, told: str
) -> None:
    with pytest.raises(ValueError, match=told):
        read_table(write(tmp_path / "table.csv", text), TWO)


def test_a_damaged_file_is_named(tmp_path: Path) -> None:
    path = tmp_path / "table.csv.gz"
    whole = gzip.compress(b"t,v,name\n" + b"1,2,a\n" * 1000)
    for damaged in (whole[: len(whole) // 2], b"no gzip"):
        path.write_bytes(damaged)
        with pytest.raises(ValueError, match=r"table.csv.gz cannot be read \("):
            read_table(path, TWO)


def test_groups_keep_the_order_of_first_appearance() -> None:
    keys = np.array(["b", "a", "b", "c", "a"])
    assert [rows.tolist() for rows in groups(keys)] == [[0, 2], [1, 4], [3]]
    assert list(groups(np.array([]))) == []
