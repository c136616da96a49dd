"""Records of before are read, and every record says who drove and in which version."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pyarrow.parquet as pq
import pytest

from costeer.records.columns import TrialRecord
from costeer.records.record import read_record, read_stream, write_record
from tests.study.synthetic import synthetic_record

OLD = Path(__file__).parents[1] / "data" / "records"


@pytest.fixture(scope="module")
def record() -> TrialRecord:
    return synthetic_record("weak-normal", length=900.0)


def test_a_virtual_trial_of_version_1_is_read() -> None:
    metadata, columns, added = read_record(OLD / "virtual-1.parquet")
    assert metadata["driver"] == "virtual, population 2"
    assert metadata["driver_kind"] == "virtual"
    assert metadata["seed"] == 3
    assert (len(columns), added) == (43, ())
    assert not columns["torque_fault"].any()  # nothing was over the limit then
    # Nor was there a road with a bend, or anything to hit.
    assert not columns["road_curvature"].any()
    assert not columns["contact"].any()
    assert not columns["driver_indicator"].any()
    assert not columns["crossing_side"].any()
    # 1.5 s at 70 km/h, 19.44 m/s; the virtual driver holds the speed within a few %.
    assert columns["time"][-1] == pytest.approx(89.0 / 60.0)
    assert columns["longitudinal_position"][-1] == pytest.approx(28.8, rel=0.05)
    assert set(columns["mode"]) == {"lane_keeping", "lane_changing"}
    assert np.isnan(columns["lead_distance"]).all()


def test_what_a_person_drove_in_version_1_is_read() -> None:
    metadata, columns, _ = read_stream(OLD / "person-1.arrow")
    assert metadata["driver"] == "person, virtual hands"
    assert metadata["driver_kind"] == "person"
    assert metadata["markers"] == [{"time": 0.0, "kind": "started", "text": ""}]
    # Half a second, the second half of it in manual; nobody wrote down the date.
    assert columns["mode"].tolist() == ["lane_keeping"] * 15 + ["manual"] * 15
    assert columns["driver_intention"].mask.all()
    assert not {"started_at", "ended_at"} & set(metadata)


def test_a_record_of_version_1_is_written_again_in_this_version(tmp_path: Path) -> None:
    old = read_record(OLD / "virtual-1.parquet")
    write_record(tmp_path / "new.parquet", old)
    assert (
        b'"record_version": 2'
        in pq.read_schema(tmp_path / "new.parquet").metadata[b"costeer"]
    )
    new = read_record(tmp_path / "new.parquet")
    assert new.metadata == old.metadata
    for name, values in old.columns.items():
        assert new.columns[name].tobytes() == values.tobytes(), name


def rewritten(path: Path, changes: dict[str, object], without: tuple[str, ...]) -> None:
    """Change the description in a file as another version would have written it."""
    table = pq.read_table(path)
    about = json.loads(table.schema.metadata[b"costeer"]) | changes
    kept = {name: value for name, value in about.items() if name not in without}
    pq.write_table(table.replace_schema_metadata({"costeer": json.dumps(kept)}), path)


@pytest.mark.parametrize(
    ("driver", "kind"),
    [
        ("virtual, population 1", "virtual"),
        ("hands-off, population 2", "hands-off"),
        ("person, Logitech G29", "person"),
        ("human", "person"),  # who is not known to be virtual may be somebody
    ],
)
def test_the_driver_of_version_1_is_of_the_kind_that_the_text_told(
    driver: str, kind: str, tmp_path: Path, record: TrialRecord
) -> None:
    path = tmp_path / "old.parquet"
    write_record(path, record)
    rewritten(path, {"driver": driver}, ("driver_kind", "record_version"))
    assert read_record(path).metadata["driver_kind"] == kind


@pytest.mark.parametrize("version", [3, 0, "2", None])
def test_a_version_that_is_not_known_is_refused(
    version: object, tmp_path: Path, record: TrialRecord
) -> None:
    path = tmp_path / "new.parquet"
    write_record(path, record)
    rewritten(path, {"record_version": version}, ())
    with pytest.raises(ValueError, match=f"record_version is {version!r}; this cos"):
        read_record(path)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"record_version": 1}, "record_version is 1; records are written as 2"),
        ({"driver_kind": "robot"}, "'robot'; choose from virtual, person, hands-off"),
        ({"started_at": "2026-01-31T09:30:00+00:00"}, "that no person drove"),
        (
            {"driver_kind": "person", "started_at": "2026-01-31T09:30:00+01:00"},
            "give a moment in UTC",
        ),
        ({"driver_kind": "person", "ended_at": "yesterday"}, "'yesterday'; give a mom"),
    ],
)
def test_a_description_that_is_not_true_is_not_written(
    changes: dict[str, object], message: str, tmp_path: Path, record: TrialRecord
) -> None:
    told = record._replace(metadata=record.metadata | changes)
    with pytest.raises(ValueError, match=message):
        write_record(tmp_path / "t.parquet", told)
    assert list(tmp_path.iterdir()) == []


def test_a_person_s_record_says_when(tmp_path: Path, record: TrialRecord) -> None:
    when = {
        "driver_kind": "person",
        "started_at": "2026-01-31T09:30:00+00:00",
        "ended_at": "2026-01-31T09:37:12Z",
    }
    path = tmp_path / "t.parquet"
    write_record(path, record._replace(metadata=record.metadata | when))
    assert read_record(path).metadata["ended_at"] == "2026-01-31T09:37:12Z"
