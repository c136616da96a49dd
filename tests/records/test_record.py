"""Trial records: what is written is read back, and what is broken is said to be."""

from __future__ import annotations

import errno
import json
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.csv
import pyarrow.parquet as pq
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as npst

from costeer.records.record import (
    COLUMNS,
    METADATA_FIELDS,
    MODES,
    Column,
    TrialRecord,
    read_record,
    read_recording,
    write_record,
)
from tests.study.synthetic import synthetic_record


@pytest.fixture(scope="module")
def record() -> TrialRecord:
    return synthetic_record("weak-normal", length=900.0)


@pytest.fixture
def path(tmp_path: Path, record: TrialRecord) -> Path:
    write_record(tmp_path / "trial.parquet", record)
    return tmp_path / "trial.parquet"


def changed(record: TrialRecord, **columns: Any) -> TrialRecord:
    return TrialRecord(record.metadata, record.columns | columns)


def assert_same(left: np.ndarray, right: np.ndarray) -> None:
    np.testing.assert_array_equal(np.ma.getmaskarray(left), np.ma.getmaskarray(right))
    defined = ~np.ma.getmaskarray(left)
    kept, got = np.ma.getdata(left)[defined], np.ma.getdata(right)[defined]
    if kept.dtype.kind == "f":  # bit for bit, so -0.0 and the payload of NaN too
        kept, got = kept.view(np.int64), got.view(np.int64)
    np.testing.assert_array_equal(kept, got)


def values_of(column: Column, num_rows: int) -> st.SearchStrategy[np.ndarray]:
    plain: st.SearchStrategy[np.ndarray]
    if column.name == "time":
        return st.just(np.arange(num_rows) / 60.0)
    if column.kind == "string":
        return npst.arrays("<U13", num_rows, elements=st.sampled_from(MODES))
    plain = npst.arrays(column.kind, num_rows)
    if not column.nullable:
        return plain
    masks = npst.arrays(bool, num_rows)
    return st.builds(lambda data, mask: np.ma.MaskedArray(data, mask), plain, masks)


@st.composite
def records(draw: st.DrawFn) -> TrialRecord:
    num_rows = draw(st.integers(1, 5))
    values = st.fixed_dictionaries({c.name: values_of(c, num_rows) for c in COLUMNS})
    metadata = dict.fromkeys(METADATA_FIELDS, 1) | {
        "driver": draw(st.text()),
        "driver_kind": "person",
        "record_version": 2,
    }
    return TrialRecord(metadata, draw(values))


@settings(max_examples=5)
@given(records())
def test_what_is_written_is_read_back_bit_for_bit(
    tmp_path_factory: pytest.TempPathFactory, written: TrialRecord
) -> None:
    path = tmp_path_factory.mktemp("records") / "trial.parquet"
    write_record(path, written)
    found = read_record(path)
    assert found.metadata == written.metadata
    assert list(found.columns) == [column.name for column in COLUMNS]
    for name, values in written.columns.items():
        assert_same(values, found.columns[name])


def test_the_same_record_gives_the_same_bytes(
    tmp_path: Path, record: TrialRecord, path: Path
) -> None:
    # The order in which a caller builds its dictionaries must not show.
    backwards = TrialRecord(
        dict(reversed(record.metadata.items())), dict(reversed(record.columns.items()))
    )
    write_record(tmp_path / "again.parquet", backwards)
    assert (tmp_path / "again.parquet").read_bytes() == path.read_bytes()


def test_units_stand_in_the_schema(path: Path) -> None:
    schema = pq.read_schema(path)
    assert schema.field("driver_torque").metadata[b"unit"] == "N·m".encode()
    assert schema.names == [column.name for column in COLUMNS]
    assert json.loads(schema.metadata[b"costeer"])["condition"] == "weak-normal"


def test_columns_can_be_read_alone_and_time_comes_along(path: Path) -> None:
    assert list(read_record(path, ["mode", "lane"]).columns) == ["time", "lane", "mode"]


def test_an_unknown_column_is_refused(path: Path) -> None:
    with pytest.raises(ValueError, match="unknown columns: lateral_offset"):
        read_record(path, ["lateral_offset"])


def test_what_is_read_may_be_written_to(path: Path) -> None:
    for values in read_record(path).columns.values():
        values[0] = values[-1]


def test_not_a_number_in_the_metadata_becomes_null(
    tmp_path: Path, record: TrialRecord
) -> None:
    nested = {"change_duration": float("nan"), "configuration": {"gains": (1, 2.5)}}
    write_record(tmp_path / "t", TrialRecord(record.metadata | nested, record.columns))
    metadata = read_record(tmp_path / "t").metadata
    assert metadata["change_duration"] is None
    assert metadata["configuration"] == {"gains": [1, 2.5]}


def test_an_infinite_number_in_the_metadata_is_refused(
    tmp_path: Path, record: TrialRecord
) -> None:
    endless = TrialRecord(record.metadata | {"speed": np.inf}, record.columns)
    with pytest.raises(ValueError, match="infinite"):
        write_record(tmp_path / "t", endless)


@pytest.mark.parametrize("share", [0.0, 0.001, 0.5, 0.9999])
def test_a_truncated_file_is_refused(path: Path, share: float) -> None:
    whole = path.read_bytes()
    path.write_bytes(whole[: int(share * len(whole))])
    with pytest.raises(ValueError, match=r"trial\.parquet.*cut short"):
        read_record(path)


@pytest.mark.parametrize("place", [0.2, 0.5, 0.7])
def test_a_flipped_byte_is_noticed(path: Path, place: float) -> None:
    damaged = bytearray(path.read_bytes())
    damaged[int(place * len(damaged))] ^= 0xFF
    path.write_bytes(damaged)
    with pytest.raises(ValueError, match=r"trial\.parquet"):
        read_record(path)


def test_text_is_no_parquet(path: Path) -> None:
    path.write_text("time,steering_wheel_angle\n0,0\n")
    with pytest.raises(ValueError, match="not a Parquet file"):
        read_record(path)


def test_a_plain_table_is_no_record(path: Path) -> None:
    pq.write_table(pa.table({"time": [0.0, 1.0]}), path)
    with pytest.raises(ValueError, match="no 'costeer' metadata"):
        read_record(path)


def test_metadata_that_is_not_json_is_refused(path: Path) -> None:
    table = pq.read_table(path)
    pq.write_table(table.replace_schema_metadata({"costeer": "{"}), path)
    with pytest.raises(ValueError, match="not JSON"):
        read_record(path)


def test_missing_metadata_fields_are_named(path: Path) -> None:
    table = pq.read_table(path)
    pq.write_table(table.replace_schema_metadata({"costeer": '{"seed": 1}'}), path)
    with pytest.raises(ValueError, match="lacks the metadata fields version, part"):
        read_record(path)


def test_missing_columns_are_named(path: Path) -> None:
    pq.write_table(pq.read_table(path).drop_columns(["brake", "lane"]), path)
    with pytest.raises(ValueError, match="lacks the columns lane, brake"):
        read_record(path)
    assert "yaw_angle" in read_record(path, ["yaw_angle"]).columns


def replaced(path: Path, name: str, values: pa.Array) -> None:
    table = pq.read_table(path)
    place = table.column_names.index(name)
    pq.write_table(table.set_column(place, name, values), path)


def test_a_column_of_the_wrong_kind_is_refused(path: Path, record: TrialRecord) -> None:
    replaced(path, "lane", pa.array(["left"] * len(record.columns["time"])))
    with pytest.raises(ValueError, match="'lane' holds string, expected int8"):
        read_record(path)


def test_nulls_where_none_may_be_are_refused(path: Path, record: TrialRecord) -> None:
    num_rows = len(record.columns["time"])
    replaced(path, "lane", pa.array([None] * num_rows, pa.int8()))
    with pytest.raises(ValueError, match="'lane' has undefined samples"):
        read_record(path)


def test_time_on_disk_must_be_finite(path: Path, record: TrialRecord) -> None:
    time = record.columns["time"].copy()
    time[3] = np.inf
    replaced(path, "time", pa.array(time))
    with pytest.raises(ValueError, match=r"trial\.parquet: time is inf in row 3"):
        read_record(path)


def test_a_missing_file_stays_an_operating_system_error(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError):
        read_record(tmp_path / "none.parquet")
    with pytest.raises(FileNotFoundError):
        read_recording(tmp_path / "none.csv")


def broken(record: TrialRecord) -> dict[str, tuple[TrialRecord, str]]:
    num_rows = len(record.columns["time"])
    time = record.columns["time"]
    without = {k: v for k, v in record.columns.items() if k != "brake"}
    lane = record.columns["lane"]
    return {
        "missing column": (TrialRecord(record.metadata, without), "missing.*: brake"),
        "unknown column": (changed(record, pedal=time), "unknown columns: pedal"),
        "missing field": (TrialRecord({}, record.columns), "missing metadata fields"),
        "unequal": (changed(record, brake=time[:-1]), f"'brake' has {num_rows - 1} ro"),
        "two axes": (changed(record, brake=time[:, None]), "2 dimensions"),
        "float lane": (changed(record, lane=time), "'lane' holds float64"),
        "large lane": (changed(record, lane=lane.astype(int) + 200), "to 201"),
        "int time": (changed(record, time=lane), "'time' holds int8, expected float64"),
        "undefined": (
            changed(record, lane=np.ma.MaskedArray(lane, mask=True)),
            "'lane' has undefined samples",
        ),
        "nan time": (changed(record, time=time * np.nan), "time is nan in row 0"),
        "backwards": (changed(record, time=time[::-1]), "does not increase in row 1"),
        "standing": (changed(record, time=time * 0.0), "does not increase in row 1"),
        "mode": (
            changed(record, mode=np.full(num_rows, "parking")),
            "mode is 'parking' in row 0",
        ),
        "empty": (
            TrialRecord(record.metadata, {k: v[:0] for k, v in record.columns.items()}),
            "at least one row",
        ),
    }


@pytest.mark.parametrize("fault", broken(synthetic_record(length=900.0)))
def test_an_invalid_record_is_not_written(
    tmp_path: Path, record: TrialRecord, fault: str
) -> None:
    invalid, message = broken(record)[fault]
    with pytest.raises(ValueError, match=message):
        write_record(tmp_path / "trial.parquet", invalid)
    assert list(tmp_path.iterdir()) == []


def test_a_failed_write_leaves_the_old_file(
    path: Path, record: TrialRecord, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fill_disk(table: pa.Table, target: Path, **_: object) -> None:
        target.write_bytes(b"PAR1 and then no space")
        raise OSError(28, "No space left on device")

    before = path.read_bytes()
    monkeypatch.setattr(pq, "write_table", fill_disk)
    with pytest.raises(OSError, match="No space"):
        write_record(path, record)
    assert path.read_bytes() == before
    assert list(path.parent.iterdir()) == [path]


def test_plain_integers_do_for_masked_ones(tmp_path: Path, record: TrialRecord) -> None:
    lane = record.columns["lane"]
    write_record(tmp_path / "t", changed(record, target_lane=lane.astype(np.int64)))
    target = read_record(tmp_path / "t").columns["target_lane"]
    assert isinstance(target, np.ma.MaskedArray)
    assert not target.mask.any()


def test_a_recording_is_a_record_or_any_table(tmp_path: Path, path: Path) -> None:
    assert read_recording(path).metadata["participant"] == 1
    table = pa.table(
        {
            "t": [0.0, 0.1, 0.2],
            "gear": [1, 2, 3],
            "angle": [1, None, 3],
            "part": ["a", "a", "b"],
            "on": [True, None, False],
            "nothing": pa.nulls(3),
            "day": pa.array([0, 1, 2], pa.date32()),
        }
    )
    pq.write_table(table, tmp_path / "table.parquet")
    pyarrow.csv.write_csv(table, tmp_path / "table.csv")
    for name in ("table.parquet", "table.csv"):
        found = read_recording(tmp_path / name)
        columns = found.columns
        assert found.metadata == {}
        assert list(columns) == table.column_names
        assert columns["day"].tolist() == ["1970-01-01", "1970-01-02", "1970-01-03"]
        np.testing.assert_array_equal(columns["angle"], [1.0, np.nan, 3.0])
        np.testing.assert_array_equal(columns["gear"], [1, 2, 3])
        assert columns["part"].tolist() == ["a", "a", "b"]
        assert columns["on"].tolist() == [True, None, False]
        assert np.isnan(columns["nothing"]).all()


def test_a_ragged_csv_is_refused(tmp_path: Path) -> None:
    (tmp_path / "t.csv").write_text("time,angle\n0,1\n0.1\n")
    with pytest.raises(ValueError, match=r"t\.csv is no CSV table"):
        read_recording(tmp_path / "t.csv")


def test_a_damaged_gzip_is_refused(tmp_path: Path) -> None:
    (tmp_path / "t.csv.gz").write_bytes(b"\x1f\x8b\x08\x00 no more")
    with pytest.raises(ValueError, match="is no CSV table"):
        read_recording(tmp_path / "t.csv.gz")


@pytest.mark.parametrize("names", ["time,yaw_angle,yaw_angle", "0.1,0.2,0.2"])
def test_a_name_that_stands_twice_is_refused(names: str, tmp_path: Path) -> None:
    path = tmp_path / "twice.csv"
    path.write_text(f"{names}\n0.0,1.0,2.0\n")
    with pytest.raises(ValueError, match=r"twice\.csv: 2 columns have the name"):
        read_recording(path)


def test_a_table_between_semicolons_is_read(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_text("time;yaw_angle\n0,0;1,5\n")
    assert read_recording(path).columns["yaw_angle"].tolist() == [1.5]


def test_a_full_disk_names_the_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*_: object, **__: object) -> None:
        # As pyarrow says it: without a file name.
        raise OSError(errno.ENOSPC, "Error writing bytes to file. Detail: [errno 28]")

    monkeypatch.setattr(pq, "write_table", full)
    path = tmp_path / "a.parquet"
    with pytest.raises(OSError, match="No space left on device") as told:
        write_record(path, synthetic_record(length=400.0))
    assert told.value.filename == str(path)
    assert not any(tmp_path.iterdir())
