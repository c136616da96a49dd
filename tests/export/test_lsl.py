"""Lab Streaming Layer: what the outlet gives, an inlet on this computer takes."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator

import pylsl
import pytest

from costeer.export.lsl import MARKER_TYPE, STATE_TYPE, TrialOutlet, lsl_clock
from costeer.runtime.markers import Marker
from tests.waiting import PATIENCE

COLUMNS = {"time": "s", "driver_torque": "N·m", "haptic_gain": "-"}


@pytest.fixture
def source(request: pytest.FixtureRequest) -> str:
    """Unlike that of any test that runs at the same time."""
    return f"costeer-{os.getpid()}-{request.node.name}"


@pytest.fixture
def outlet(source: str) -> Iterator[TrialOutlet]:
    made = TrialOutlet(COLUMNS, name="costeer-test", source=source)
    yield made
    made.close()


def inlet(source: str) -> pylsl.StreamInlet:
    """An inlet that is connected."""
    found = pylsl.resolve_byprop("source_id", source, timeout=PATIENCE)
    assert len(found) == 1
    opened = pylsl.StreamInlet(found[0])
    opened.open_stream(timeout=PATIENCE)
    return opened


def test_state_and_markers_arrive_with_times_labels_and_units(
    outlet: TrialOutlet, source: str
) -> None:
    state, markers = inlet(f"{source}-state"), inlet(f"{source}-markers")
    now = lsl_clock()
    outlet.push([0.5, -1.25, float("nan")], now)
    gain = Marker("parameter", "lateral_error_gain", 1.5, 2.5, "N·m/m", time=61.25)
    outlet.mark(gain, now + 0.25)
    outlet.mark(Marker("paused", "driver"))
    sample, time = state.pull_sample(PATIENCE)
    assert sample == pytest.approx([0.5, -1.25, float("nan")], abs=0, nan_ok=True)
    assert time == now
    (text,), time = markers.pull_sample(PATIENCE)
    assert time == now + 0.25
    assert json.loads(text) == {
        "kind": "parameter",
        "name": "lateral_error_gain",
        "before": 1.5,
        "after": 2.5,
        "unit": "N·m/m",
        "time": 61.25,
    }
    (text,), time = markers.pull_sample(PATIENCE)
    assert json.loads(text) == {"kind": "paused", "name": "driver", "time": 0.0}
    assert now <= time <= lsl_clock()
    about = state.info(PATIENCE)
    assert (about.name(), about.type(), about.nominal_srate()) == (
        "costeer-test",
        STATE_TYPE,
        60.0,
    )
    assert about.get_channel_labels() == list(COLUMNS)
    assert about.get_channel_units() == list(COLUMNS.values())
    assert markers.info(PATIENCE).type() == MARKER_TYPE


def test_a_sample_of_the_wrong_length_is_refused(outlet: TrialOutlet) -> None:
    with pytest.raises(ValueError, match="has 2 numbers; the stream has 3 columns"):
        outlet.push([1.0, 2.0])


def test_a_stream_without_columns_is_refused() -> None:
    with pytest.raises(ValueError, match="0 columns"):
        TrialOutlet({})
