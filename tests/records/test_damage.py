"""Whatever is damaged is refused in one line, or read as far as it is whole."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.ipc
import pyarrow.parquet as pq
import pytest

from costeer.records.arrow import METADATA_KEY, batch_checksum, to_table
from costeer.records.record import read_noted, read_recording, write_record
from costeer.records.stream import CHECKSUM_KEY
from tests.study.synthetic import synthetic_record

RECORD = synthetic_record("weak-normal", length=400.0)


def described(metadata: object, path: Path) -> Path:
    """A record whose description is another one."""
    table = to_table(RECORD)
    text = json.dumps(metadata).encode()
    pq.write_table(table.replace_schema_metadata({METADATA_KEY: text}), path)
    return path


@pytest.mark.parametrize("metadata", [3, [1], "text", None])
def test_a_description_that_is_none_is_refused(
    metadata: object, tmp_path: Path
) -> None:
    path = described(metadata, tmp_path / "a.parquet")
    with pytest.raises(ValueError, match=r"a\.parquet: its description is damaged"):
        read_recording(path)


@pytest.mark.parametrize("number", [10**400, -(10**16)])
def test_a_huge_number_in_the_description_is_refused(
    number: int, tmp_path: Path
) -> None:
    metadata = {**RECORD.metadata, "replan_gain": number}
    path = described(metadata, tmp_path / "a.parquet")
    with pytest.raises(ValueError, match="replan_gain is too large a number"):
        read_recording(path)


def test_a_column_that_a_record_has_twice_is_refused(tmp_path: Path) -> None:
    table = to_table(RECORD)
    twice = table.append_column(table.field("intention"), table.column("intention"))
    pq.write_table(twice, tmp_path / "a.parquet")
    with pytest.raises(ValueError, match="2 columns have the name 'intention'"):
        read_recording(tmp_path / "a.parquet")


@pytest.mark.parametrize("seed", range(60))
def test_damage_anywhere_is_told_in_one_line(seed: int, tmp_path: Path) -> None:
    rng = np.random.default_rng(seed)
    path = tmp_path / "a.parquet"
    write_record(path, RECORD)
    content = bytearray(path.read_bytes())
    # Most of what is not under a checksum lies at the end.
    place = len(content) - int(rng.integers(8, min(len(content), 20_000)))
    content[place : place + 8] = rng.bytes(8)
    path.write_bytes(content)
    told = ""
    try:
        read_recording(path)
    except ValueError as error:
        told = str(error)
    assert not told or "a.parquet" in told


def stream(path: Path, checksums: bool) -> list[int]:
    """Write a drive as batches; where each of them ends."""
    ends = []
    table = to_table(RECORD).combine_chunks()
    with (
        path.open("wb") as file,
        pa.ipc.new_stream(file, table.schema) as writer,
    ):
        for batch in table.to_batches(max_chunksize=15)[:12]:
            fresh = pa.concat_batches([batch])
            told = {CHECKSUM_KEY: str(batch_checksum(fresh))} if checksums else None
            writer.write_batch(fresh, custom_metadata=told)
            ends.append(file.tell())
    return ends


def test_a_whole_stream_is_read(tmp_path: Path) -> None:
    for checksums in (True, False):
        stream(tmp_path / "a.arrow", checksums)
        found = read_noted(tmp_path / "a.arrow")
        assert len(found.record.columns["time"]) == 180
        assert any("no checksums" in note for note in found.notes) != checksums
        assert "damage" not in found.record.metadata


@pytest.mark.parametrize("kind", ["insert", "double", "zero", "noise"])
@pytest.mark.parametrize("seed", range(8))
def test_of_a_damaged_stream_the_whole_batches_are_kept(
    kind: str, seed: int, tmp_path: Path
) -> None:
    path, rng = tmp_path / "a.arrow", np.random.default_rng(seed)
    ends = stream(path, checksums=True)
    content = path.read_bytes()
    place = int(rng.integers(ends[2], ends[3] - 400))
    change = {
        "insert": content[:place] + rng.bytes(63) + content[place:],
        "double": content[: place + 391] + content[place:],
        "zero": content[:place] + bytes(64) + content[place + 64 :],
        "noise": content[:place] + rng.bytes(64) + content[place + 64 :],
    }
    path.write_bytes(change[kind])
    found = read_noted(path)
    num_rows = len(found.record.columns["time"])
    if num_rows == 180:  # zeros over zeros
        assert kind == "zero"
        return
    assert num_rows == 45
    assert any("batch 4 of the stream is damaged" in note for note in found.notes)
    assert "the 45 rows before it are kept" in str(found.record.metadata["damage"])


def test_times_that_jump_are_damage(tmp_path: Path) -> None:
    table = to_table(RECORD).combine_chunks()
    first, _, third = table.to_batches(max_chunksize=15)[:3]
    with pa.ipc.new_stream(tmp_path / "a.arrow", table.schema) as writer:
        writer.write_batch(pa.concat_batches([first]))
        writer.write_batch(pa.concat_batches([third]))
    found = read_noted(tmp_path / "a.arrow")
    assert len(found.record.columns["time"]) == 15
    assert "after 0.233333 s follows 0.5 s" in found.notes[0]
