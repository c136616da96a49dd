"""A stream's channel is chosen by label and unit; its clock becomes this one."""

from __future__ import annotations

import math
import time

import pytest

from costeer.devices.head import lsl
from costeer.devices.head.lsl import Channel, Layout, LslTracker, layout, sample_yaw
from costeer.devices.head.source import HeadDescription, HeadLost, HeadReading
from tests.devices.head.fake_outlet import FakeOutlet
from tests.waiting import PATIENCE

EYES = [Channel("GazeX", "m"), Channel("Head_Yaw", "rad"), Channel("Quality", "")]
ANY = HeadDescription("lsl", "eyes")


def test_the_channel_with_the_yaw_is_found_by_its_label() -> None:
    assert layout(ANY, EYES) == Layout(yaw=1, unit=1.0, validity=None)


@pytest.mark.parametrize("unit", ["deg", "degrees", "Degree", " ° "])
def test_degrees_become_radians(unit: str) -> None:
    chosen = layout(ANY, [Channel("yaw", unit)])
    assert sample_yaw(chosen, [90.0]) == pytest.approx(math.pi / 2.0)


def test_what_the_user_says_counts_more_than_the_stream() -> None:
    said = HeadDescription("lsl", "eyes", "GazeX", "deg", "Quality")
    assert layout(said, EYES) == Layout(0, math.pi / 180.0, 2)


@pytest.mark.parametrize(
    ("description", "channels", "told"),
    [
        (ANY, [Channel("GazeX", "m")], "--channel, one of GazeX"),
        (ANY, [Channel("yaw", "rad"), Channel("HeadYaw", "rad")], "2 of the"),
        (ANY, [Channel("", ""), Channel("", "")], "no labels"),
        (ANY, [Channel("yaw", "px")], "'px'; say what it is with --unit"),
        (ANY, [Channel("yaw", "")], "--unit rad or --unit deg"),
        (HeadDescription("lsl", "eyes", "Yaw"), EYES, "0 channels 'Yaw'"),
        (HeadDescription("lsl", "e", "", "", "Valid"), EYES, "0 channels 'Valid'"),
    ],
)
def test_a_stream_that_is_not_plain_is_refused(
    description: HeadDescription, channels: list[Channel], told: str
) -> None:
    with pytest.raises(ValueError, match=told):
        layout(description, channels)


def test_a_head_that_the_tracker_does_not_see_gives_no_yaw() -> None:
    chosen = Layout(yaw=0, unit=1.0, validity=1)
    assert sample_yaw(chosen, [0.4, 1.0]) == 0.4
    assert sample_yaw(chosen, [0.4, 0.5]) is None
    assert sample_yaw(chosen, [0.4, math.nan]) is None
    assert sample_yaw(chosen, [math.nan, 1.0]) is None
    assert sample_yaw(chosen, [math.inf, 1.0]) is None
    assert sample_yaw(chosen, [4.0, 1.0]) is None


def read_until_new(tracker: LslTracker, after: float) -> HeadReading:
    """The first reading with a new time."""
    end = time.monotonic() + PATIENCE
    while time.monotonic() < end:
        reading = tracker.read()
        if reading.time > after:
            return reading
    pytest.fail("nothing came")


@pytest.mark.slow
def test_samples_travel_from_an_outlet_with_their_time() -> None:
    outlet = FakeOutlet([("Head Yaw", "deg"), ("Valid", "")])
    tracker = LslTracker(HeadDescription("lsl", outlet.name, validity="Valid"))
    try:
        assert not tracker.read().valid
        before = time.monotonic()
        outlet.send(5.0, 1.0, age=5.0)
        old = read_until_new(tracker, -math.inf)
        assert not old.valid  # too old, by the stream's clock
        assert math.degrees(old.head_yaw) == pytest.approx(5.0)
        # Both clocks are of this computer: apart by far less than a second.
        assert before - 1.0 < old.time + 5.0 < time.monotonic() + 1.0
        outlet.send(25.0, 1.0, age=-0.1)  # a busy machine may hold it up
        assert math.degrees(read_until_new(tracker, old.time).head_yaw) == (
            pytest.approx(25.0)
        )
        outlet.send(math.nan, 1.0)
        held = tracker.read()
        assert math.degrees(held.head_yaw) == pytest.approx(25.0)
    finally:
        tracker.close()


def test_two_streams_of_one_name_are_refused() -> None:
    one = FakeOutlet([("Head Yaw", "deg")])
    other = FakeOutlet([("Head Yaw", "deg")], one.name)
    assert other.name == one.name
    with pytest.raises(ValueError, match=f"2 LSL streams are called '{one.name}'"):
        LslTracker(HeadDescription("lsl", one.name))


@pytest.mark.slow
def test_samples_that_another_clock_has_stamped_are_refused() -> None:
    outlet = FakeOutlet([("Head Yaw", "deg")])
    tracker = LslTracker(HeadDescription("lsl", outlet.name))
    try:
        tracker.read()
        outlet.send(5.0, age=-1.7e9)  # of the Unix clock
        with pytest.raises(HeadLost, match="stamps its samples with another clock"):
            read_until_new(tracker, -math.inf)
    finally:
        tracker.close()


def test_a_stream_that_is_not_there_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(lsl, "FIND_WITHIN", 0.2)
    with pytest.raises(HeadLost, match="no LSL stream 'no such tracker'"):
        LslTracker(HeadDescription("lsl", "no such tracker"))
