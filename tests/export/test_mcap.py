"""MCAP: a reader finds every value of the record, and the file says what it is."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from google.protobuf import descriptor_pb2, descriptor_pool, message_factory
from hypothesis import given, settings
from hypothesis import strategies as st
from mcap.reader import make_reader

from costeer.export.mcap import write_mcap
from costeer.records.record import COLUMNS, TrialRecord
from tests.study.synthetic import synthetic_record

MARKERS = [
    {"time": 0.25, "kind": "condition", "before": "manual", "after": "weak-rapid"},
    {
        "time": 0.5,
        "kind": "parameter",
        "name": "lateral_error_gain",
        "before": 1.5,
        "after": 2.0,
        "unit": "N·m/m",
    },
    {"time": 1.25, "kind": "paused", "name": "experimenter"},
]


@pytest.fixture(scope="module")
def record() -> TrialRecord:
    plain = synthetic_record("strong-normal", length=1300.0)
    about = plain.metadata | {"markers": MARKERS}
    alone = np.arange(len(plain.columns["time"])) % 3 > 0
    lead_lane = np.ma.MaskedArray(np.ones(len(alone), np.int8), mask=alone)
    columns = plain.columns | {"lead_lane": lead_lane}
    return TrialRecord(about | {"speed": float("nan")}, columns)


@pytest.fixture(scope="module")
def path(tmp_path_factory: pytest.TempPathFactory, record: TrialRecord) -> Path:
    path = tmp_path_factory.mktemp("mcap") / "trial.mcap"
    write_mcap(record, path)
    return path


def decoded(path: Path, topic: str) -> Iterator[tuple[Any, Any, Any]]:
    """Channel, envelope and message, read by the descriptor in the file alone."""
    classes: dict[int, Any] = {}
    with path.open("rb") as stream:
        reader = make_reader(stream, validate_crcs=True)
        for schema, channel, message in reader.iter_messages([topic]):
            if schema.id not in classes:
                pool = descriptor_pool.DescriptorPool()
                described = descriptor_pb2.FileDescriptorSet.FromString(schema.data)
                for file in described.file:
                    pool.Add(file)
                found = pool.FindMessageTypeByName(schema.name)
                classes[schema.id] = message_factory.GetMessageClass(found)
            yield channel, message, classes[schema.id].FromString(message.data)


def expected(record: TrialRecord, name: str) -> np.ndarray:
    """What a reader should find in a column."""
    values = record.columns[name]
    if values.dtype.kind == "U" or (
        values.dtype.kind == "b" and not isinstance(values, np.ma.MaskedArray)
    ):
        return values
    gaps = np.ma.getmaskarray(values)
    return np.where(gaps, np.nan, np.ma.getdata(values).astype(float))


def test_every_value_of_the_record_is_read_back(
    path: Path, record: TrialRecord
) -> None:
    samples = [sample for _, _, sample in decoded(path, "/trial")]
    assert len(samples) == len(record.columns["time"])
    for column in COLUMNS:
        found = np.array([getattr(sample, column.name) for sample in samples])
        np.testing.assert_array_equal(
            found, expected(record, column.name), err_msg=column.name
        )
    assert type(samples[0].head_yaw_valid) is bool
    # With a leader and without: both kinds of value were looked at.
    assert 0 < np.isnan([sample.lead_lane for sample in samples]).sum() < len(samples)


def test_messages_bear_the_time_of_their_row(path: Path, record: TrialRecord) -> None:
    found = [
        (m.log_time, m.publish_time, m.sequence) for _, m, _ in decoded(path, "/trial")
    ]
    wanted = [
        (round(time * 1e9), round(time * 1e9), number)
        for number, time in enumerate(record.columns["time"].tolist())
    ]
    assert found == wanted


def test_units_and_the_trial_are_in_the_file(path: Path, record: TrialRecord) -> None:
    channel, _, _ = next(decoded(path, "/trial"))
    assert channel.metadata == {column.name: column.unit for column in COLUMNS}
    with path.open("rb") as stream:
        (about,) = make_reader(stream).iter_metadata()
    trial = json.loads(about.metadata["trial"])
    assert about.name == "costeer"
    assert trial["condition"] == "strong-normal"
    assert trial["speed"] is None


def test_markers_have_a_topic_of_their_own(path: Path) -> None:
    stamps, said = zip(
        *((m.log_time, s) for _, m, s in decoded(path, "/markers")), strict=True
    )
    assert stamps == (250_000_000, 500_000_000, 1_250_000_000)
    chosen, tuned, paused = said
    assert (chosen.kind, chosen.before_name, chosen.after_name) == (
        "condition",
        "manual",
        "weak-rapid",
    )
    assert np.isnan([chosen.before, chosen.after]).all()
    assert (tuned.name, tuned.before, tuned.after) == ("lateral_error_gain", 1.5, 2.0)
    assert (tuned.unit, tuned.before_name) == ("N·m/m", "")
    assert (paused.time, paused.name) == (1.25, "experimenter")
    assert [each.text for each in said] == [
        "condition: manual → weak-rapid",
        "lateral_error_gain: 1.5 → 2 N·m/m",
        "paused: by the experimenter",
    ]


def test_the_same_record_gives_the_same_bytes(
    path: Path, record: TrialRecord, tmp_path: Path
) -> None:
    write_mcap(record, tmp_path / "again.mcap")
    assert (tmp_path / "again.mcap").read_bytes() == path.read_bytes()


@settings(max_examples=20)
@given(
    st.lists(st.floats(), min_size=1, max_size=4),
    st.text(st.characters(exclude_categories=["Cs"])),
)
def test_foreign_tables_keep_every_float_and_text(
    tmp_path_factory: pytest.TempPathFactory, numbers: list[float], text: str
) -> None:
    path = tmp_path_factory.mktemp("mcap") / "t.mcap"
    columns = {
        "number": np.array(numbers),
        "time": np.arange(len(numbers)) / 10.0,
        "note": np.full(len(numbers), text),
    }
    write_mcap(TrialRecord({}, columns), path)
    samples = [sample for _, _, sample in decoded(path, "/trial")]
    np.testing.assert_array_equal([s.number for s in samples], numbers)
    # NumPy's text arrays drop zeros at the end.
    assert {sample.note for sample in samples} == {text.rstrip("\0")}


@pytest.mark.parametrize(
    ("columns", "told"),
    [
        ({"speed": np.zeros(2)}, "no column time"),
        ({"time": np.zeros(2)}, "time does not increase"),
        ({"time": np.array([-1.0, 0.0])}, "time goes from -1.0 to 0.0 s"),
        ({"time": np.array([0.0, 1e10])}, "MCAP takes 0 to"),
        ({"time": np.arange(2.0), "v (km/h)": np.zeros(2)}, "'v .km/h.' cannot be"),
        ({"time": np.arange(2.0), "a_b": np.zeros(2), "aB": np.zeros(2)}, "refuses"),
    ],
)
def test_what_the_format_cannot_hold_is_refused(
    columns: dict[str, np.ndarray], told: str, tmp_path: Path
) -> None:
    with pytest.raises(ValueError, match=told):
        write_mcap(TrialRecord({}, columns), tmp_path / "t.mcap")
    assert list(tmp_path.iterdir()) == []
