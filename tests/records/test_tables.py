"""Tables of others: kind, separator, decimal mark, encoding and times are found out."""

from __future__ import annotations

import gzip
from pathlib import Path

import numpy as np
import pandas as pd
import pyarrow as pa
import pyarrow.ipc
import pyarrow.parquet as pq
import pytest

from costeer.records.record import read_noted, read_recording
from costeer.records.tables import Reading

HEADER = ["time", "yaw_angle", "Lenkradwinkel"]
ROWS = [[k / 20.0, k / 1000.0, -1.25 * k] for k in range(40)]


def text(separator: str = ",", decimal: str = ".", header: list[str] = HEADER) -> str:
    lines = [separator.join(header)]
    lines += [separator.join(str(v) for v in r).replace(".", decimal) for r in ROWS]
    return "\n".join(lines)


@pytest.mark.parametrize("name", ["D.CSV", "d.txt", "d.dat", "d.tsv", "d", "d.parquet"])
def test_a_table_is_told_by_its_content(name: str, tmp_path: Path) -> None:
    (tmp_path / name).write_text(text())
    found = read_noted(tmp_path / name)
    assert found.notes == ()
    assert found.record.columns["Lenkradwinkel"][3] == -3.75


@pytest.mark.parametrize("name", ["a.parquet", "a.csv", "a.csv.gz"])
def test_parquet_is_told_by_its_content(name: str, tmp_path: Path) -> None:
    pq.write_table(pa.table({"time": [0.0, 0.1]}), tmp_path / name)
    assert read_recording(tmp_path / name).columns["time"].tolist() == [0.0, 0.1]
    packed = gzip.compress((tmp_path / name).read_bytes())
    (tmp_path / name).write_bytes(packed)
    assert read_recording(tmp_path / name).columns["time"].tolist() == [0.0, 0.1]


def test_a_plain_table_in_arrow_is_read(tmp_path: Path) -> None:
    table = pa.table({"time": [0.0, 0.1]})
    with pa.ipc.new_stream(tmp_path / "a.bin", table.schema) as writer:
        writer.write_table(table)
    with pa.ipc.new_file(tmp_path / "b.feather", table.schema) as writer:
        writer.write_table(table)
    for name in ("a.bin", "b.feather"):
        assert read_recording(tmp_path / name).columns["time"].tolist() == [0.0, 0.1]


@pytest.mark.parametrize(
    ("start", "message"),
    [
        (b"PK\x03\x04xlsx", "an Excel workbook or another zip archive"),
        (b"MATLAB 5.0 MAT-file", "a MATLAB file"),
        (b"\x89HDF\r\n", "an HDF5 or MATLAB 7.3 file"),
        (b"\x01\x00\x02\x00", "no text and of no kind that is known"),
        (b"  \n", "it is empty"),
    ],
)
def test_other_kinds_are_named_with_what_is_read(
    start: bytes, message: str, tmp_path: Path
) -> None:
    (tmp_path / "a.csv").write_bytes(start)
    with pytest.raises(ValueError, match=f"{message}.*costeer reads CSV"):
        read_recording(tmp_path / "a.csv")


@pytest.mark.parametrize("separator", [",", ";", "\t", "|", "  "])
@pytest.mark.parametrize("decimal", [".", ","])
def test_separator_and_decimal_mark_are_found_out(
    separator: str, decimal: str, tmp_path: Path
) -> None:
    if separator == decimal:
        return
    (tmp_path / "a.csv").write_text(text(separator, decimal))
    found = read_noted(tmp_path / "a.csv")
    for name, values in zip(HEADER, zip(*ROWS, strict=True), strict=True):
        np.testing.assert_array_equal(found.record.columns[name], values)
    assert ("--separator" in "".join(found.notes)) == (separator != ",")
    assert ("decimal commas (--decimal)" in "".join(found.notes)) == (decimal == ",")


@pytest.mark.parametrize(
    ("encoding", "name"),
    [
        ("utf-8", "Längs [°]"),
        ("utf-8-sig", "時間"),
        ("utf-16", "時間"),
        ("cp1252", "Längs [°]"),
        ("cp1252", "Größe für Übung"),
        ("cp932", "操舵角速度"),
    ],
)
def test_the_encoding_is_found_out(encoding: str, name: str, tmp_path: Path) -> None:
    content = text(header=["time", "yaw_angle", name]).encode(encoding)
    (tmp_path / "a.csv").write_bytes(content)
    found = read_noted(tmp_path / "a.csv")
    assert name in found.record.columns
    assert (found.notes == ()) == (encoding == "utf-8")
    again = read_noted(tmp_path / "a.csv", Reading(encoding=encoding))
    assert name in again.record.columns
    assert again.notes == ()


def test_an_unknown_encoding_is_refused(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text(text())
    with pytest.raises(ValueError, match="there is no encoding 'klingon'"):
        read_noted(tmp_path / "a.csv", Reading(encoding="klingon"))


STAMPS = pd.Timestamp("2024-05-01 10:00:00") + pd.to_timedelta(np.arange(3) / 20, "s")


@pytest.mark.parametrize(
    "times",
    [
        [str(stamp) for stamp in STAMPS],
        [stamp.isoformat() + "+09:00" for stamp in STAMPS],
        ["00:00:05.00", "00:00:05.05", "00:00:05.10"],
        [f"01.05.2024 {stamp.time()}" for stamp in STAMPS],
    ],
)
def test_texts_of_moments_become_seconds(times: list[str], tmp_path: Path) -> None:
    pd.DataFrame({"time": times}).to_csv(tmp_path / "a.csv", index=False)
    found = read_noted(tmp_path / "a.csv")
    np.testing.assert_allclose(found.record.columns["time"], [0.0, 0.05, 0.1])
    assert "seconds since the first row" in "".join(found.notes)


@pytest.mark.parametrize("unit", ["s", "ms", "us", "ns"])
def test_moments_and_durations_of_parquet_become_seconds(
    unit: str, tmp_path: Path
) -> None:
    for kind in ("timestamp", "duration"):
        numbers = [5, 6, 8]
        times = pa.array(numbers, getattr(pa, kind)(unit))
        pq.write_table(pa.table({"time": times}), tmp_path / "a.parquet")
        factor = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}[unit]
        found = read_recording(tmp_path / "a.parquet").columns["time"]
        np.testing.assert_allclose(found, np.array([0, 1, 3]) * factor)


@pytest.mark.parametrize("name", ["2021-03-01", "10:15:00", "007", "true", "1e5"])
def test_a_participant_is_a_name_whatever_it_looks_like(
    name: str, tmp_path: Path
) -> None:
    (tmp_path / "a.csv").write_text(f"time,participant\n0,{name}\n0.1,{name}\n")
    columns = read_recording(tmp_path / "a.csv").columns
    assert columns["participant"].tolist() == [name, name]


def test_a_column_that_is_not_read_is_named(tmp_path: Path) -> None:
    table = pa.table({"time": [0.0, 0.1], "points": [[1], [2, 3]]})
    pq.write_table(table, tmp_path / "a.parquet")
    assert read_noted(tmp_path / "a.parquet").notes == (
        "columns of a kind that is not read: points",
    )
