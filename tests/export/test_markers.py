"""Markers of records: those of today by their fields, those of before by their text."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from costeer.export.markers import markers_of
from costeer.runtime.markers import Kind, Marker, as_json, told

OLD = Path(__file__).with_name("old_markers.json")
"""Markers of a record that was driven before markers had fields."""


def test_record_of_before_is_read_with_numbers_units_and_names() -> None:
    markers = markers_of({"markers": json.loads(OLD.read_text(encoding="utf-8"))})
    assert [round(marker.time, 6) for marker in markers] == [
        *(0.0, 1.0, 1.0, 1.0, 1.1, 1.2, 1.3, 1.4, 1.4),
        *(1.75, 1.75, 1.866667, 1.866667, 5.166667),
    ]
    assert [marker._replace(time=0.0) for marker in markers] == [
        Marker("started"),
        Marker("condition", before="strong-normal", after="weak-gentle"),
        Marker("parameter", "strength_factor", 1.0, 0.4, "-"),
        Marker("parameter", "change_duration", 6.0, 8.0, "s"),
        Marker("parameter", "lateral_error_gain", 1.5, 2.0, "N·m/m"),
        Marker("parameter", "inconsistency_threshold", 0.025, 0.0251, "W"),
        Marker("indicator", after="right"),
        Marker("method", before="ibhs", after="manual"),
        Marker("parameter", "strength_factor", 0.4, 0.0, "-"),
        Marker("paused", note="by the driver"),
        Marker("resumed"),
        Marker(
            "fault",
            note="the real-time process stood still: resume, and see costeer doctor "
            "for priority",
        ),
        Marker("resumed"),
        Marker("ended", note="the end of the course is reached"),
    ]


@pytest.mark.parametrize(
    ("marker", "words"),
    [
        (Marker("started"), "started"),
        (Marker("method", before="ibhs", after="mine"), "method: ibhs → mine"),
        (
            Marker("parameter", "steepness", 4.0, 1 / 3, "1/s"),
            "steepness: 4 → 0.333333333 1/s",
        ),
        (Marker("parameter", "hold_time", 0.0, 0.5, "-"), "hold_time: 0 → 0.5"),
        (Marker("indicator", after="left"), "indicator: left"),
        (Marker("ended", "course"), "ended: the end of the course is reached"),
        (
            Marker("fault", "sensor_stale"),
            "fault: The steering wheel says nothing new. Check its cable.",
        ),
        (Marker("fault", "of_tomorrow"), "fault: of_tomorrow"),
        (Marker("paused", "driver", note="a phone"), "paused: by the driver, a phone"),
    ],
)
def test_people_are_told_what_happened(marker: Marker, words: str) -> None:
    assert told(marker) == words


@pytest.mark.parametrize("kind", ["condition", "parameter", "paused", "note"])
@pytest.mark.parametrize("after", ["manual", 0.0, -1.5e-7, None])
def test_what_a_record_keeps_of_a_marker_is_read_back(
    kind: Kind, after: float | str | None
) -> None:
    marker = Marker(kind, "name", 0.1, after, "N·m/m", 2.5, "a -> b")
    kept = json.loads(json.dumps([as_json(marker)]))
    assert markers_of({"markers": kept}) == [marker]


def test_only_what_has_a_time_is_a_marker() -> None:
    about: dict[str, object] = {
        "markers": [{"time": 2, "text": ""}, {"time": "2"}, {"time": float("nan")}, 5],
    }
    assert markers_of(about) == [Marker("note", time=2.0)]
    assert markers_of({}) == []


def test_what_others_wrote_is_kept_in_words() -> None:
    wrote = {"time": 1, "kind": "trigger", "value": 2.5, "note": "EEG"}
    (marker,) = markers_of({"markers": [wrote]})
    assert marker == Marker("note", "trigger", time=1.0, note="EEG, value 2.5")
    assert told(marker) == "note: trigger, EEG, value 2.5"


def test_simultaneous_markers_keep_the_order_in_which_they_happened() -> None:
    kinds = ["method", "condition", "started"]
    entries = [{"time": 1.0, "kind": kind} for kind in kinds]
    first = {"time": 0.5, "kind": "restarted"}
    markers = markers_of({"markers": [*entries, first]})
    assert [marker.kind for marker in markers] == ["restarted", *kinds]
