"""`costeer export` writes MCAP and saves cut-off drives, or refuses in one line."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pyarrow as pa
import pytest

from costeer.cli import main
from costeer.records.arrow import to_table
from costeer.records.checks import validated
from costeer.records.record import read_record, write_record
from tests.study.synthetic import synthetic_record


@pytest.fixture(scope="module")
def trial(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("record") / "trial.parquet"
    write_record(path, synthetic_record("weak-normal", length=300.0))
    return path


def test_a_record_is_written_as_mcap(
    trial: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "new" / "trial.mcap"
    assert main(["export", str(trial), "--to", "mcap", "--out", str(out)]) == 0
    assert out.read_bytes().startswith(b"\x89MCAP0\r\n")
    assert capsys.readouterr().out == f"{out}\n"


def test_what_cannot_be_exported_is_told_in_one_line(
    trial: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = str(tmp_path / "t.mcap")
    table = tmp_path / "table.csv"
    table.write_text("speed\n1\n")
    wrong = {
        "choose one of mcap, parquet": [str(trial), "--to", "rosbag", "--out", out],
        "ends in .mcap": [str(trial), "--out", str(tmp_path / "t.txt")],
        "check the path": [str(tmp_path / "no.parquet"), "--out", out],
        f"{table}: there is no column time": [str(table), "--out", out],
    }
    for told, words in wrong.items():
        assert main(["export", *words]) == 2
        shown = capsys.readouterr().err
        assert told in shown
        assert shown.count("\n") == 1
    assert sorted(each.name for each in tmp_path.iterdir()) == ["table.csv"]


def test_a_cut_off_stream_becomes_a_record(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    record = synthetic_record("weak-normal", length=300.0)
    table = to_table(validated(record))
    stream, saved = tmp_path / "drive.arrow", tmp_path / "saved.parquet"
    with pa.ipc.new_stream(stream, table.schema) as writer:
        writer.write_table(table, max_chunksize=100)
    # In the middle of the last batch, as a killed process leaves it.
    stream.write_bytes(stream.read_bytes()[:-5000])
    words = ["export", str(stream), "--to", "parquet", "--out", str(saved)]
    assert main(words) == 0
    found = read_record(saved)
    num_rows = len(found.columns["time"])
    assert num_rows == len(record.columns["time"]) // 100 * 100 > 0
    np.testing.assert_array_equal(
        found.columns["lateral_position"], record.columns["lateral_position"][:num_rows]
    )
    assert found.metadata["condition"] == "weak-normal"
    capsys.readouterr()
    assert main(words) == 2
    assert "which exists; choose another name" in capsys.readouterr().err


def test_the_record_itself_is_not_overwritten(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "trial.mcap"
    write_record(path, synthetic_record("weak-normal", length=300.0))
    before = path.read_bytes()
    assert main(["export", str(path), "--out", str(path)]) == 2
    assert "which exists" in capsys.readouterr().err
    assert path.read_bytes() == before
