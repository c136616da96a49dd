"""The real SDL2 against a faked kernel: levels, signs, length, axes, loss, end."""

from __future__ import annotations

import math
import time

import pytest

from tests.devices.wheels import fake_wheel as fake
from tests.devices.wheels.fake_wheel import Seen

pytestmark = pytest.mark.skipif(not fake.RUNS_HERE, reason=fake.REASON)

SCENARIOS = (
    "finds",
    "pushes",
    "refreshes",
    "moves",
    "wakes",
    "opens_another",
    "stops",
    "hurries",
    "loses",  # the last one: the device is gone afterwards
)
HALF_RANGE = fake.CALIBRATION.full_range / 2.0


@pytest.fixture(scope="module")
def seen(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Seen]:
    """What came of each scenario; one process, since SDL2 takes a second to import."""
    folder = tmp_path_factory.mktemp("fake_wheel")
    return fake.played("tests.devices.wheels.scenarios", SCENARIOS, folder)


def test_a_wheel_with_a_constant_force_is_found_once(seen: dict[str, Seen]) -> None:
    alone, among_all = seen["finds"].result
    assert alone == among_all
    kind, address, name, identity = alone
    assert (kind, identity) == ("sdl", "046d-c24f")
    assert address.endswith("#0")
    assert name == "Wheel that is not there"


def test_torques_become_levels_of_one_effect(seen: dict[str, Seen]) -> None:
    # Along the steering axis: some drivers take no Cartesian direction.
    assert seen["pushes"].result == [True, 2.0, True]
    # The first two are the effect as it is made and as it starts, the last is the end;
    # what is no finite torque is none.
    levels = [0, 0, 16384, -16384, 32767, -32767, 0, 0, 8192, 0]
    assert seen["pushes"].effects("level") == levels
    assert set(seen["pushes"].effects("id")) == {0}
    assert set(seen["pushes"].effects("type")) == {0x52}
    assert set(seen["pushes"].effects("direction")) == {0x4000}


def test_an_effect_dies_by_itself_and_has_no_envelope(seen: dict[str, Seen]) -> None:
    assert set(seen["pushes"].effects("length")) == {200}
    for name in ("delay", "attack", "fade"):
        assert set(seen["pushes"].effects(name)) == {0}


def test_the_devices_own_spring_is_off_and_its_gain_full(seen: dict[str, Seen]) -> None:
    switches = [line for line in seen["pushes"].log if "code=0x6" in line]
    assert switches[:2] == ["force code=0x61 value=0", "force code=0x60 value=65535"]


def test_closing_stops_and_erases_the_effect_once(seen: dict[str, Seen]) -> None:
    log = seen["pushes"].log
    assert log[-2:] == ["force code=0x0 value=0", "erase id=0"]
    assert log.count("erase id=0") == 1


def test_the_effect_is_started_again_before_it_dies(seen: dict[str, Seen]) -> None:
    # It lives 200 ms and is written every one of 450 ms: at once, then each 100 ms.
    assert seen["refreshes"].log.count("force code=0x0 value=1") == 5


def test_axes_and_buttons_come_back_in_our_units(seen: dict[str, Seen]) -> None:
    readings, axes, at = seen["moves"].result
    turned = [0.0, HALF_RANGE, HALF_RANGE / 2.0, -HALF_RANGE, 0.0, 0.0, 0.0]
    # One step of 16 bits, which have no middle.
    assert [r[0] for r in readings] == pytest.approx(turned, abs=HALF_RANGE / 32000.0)
    assert [reading[5] for reading in readings] == [0, 0, 0, 0, 0, 2, 3]
    assert readings[0][3:5] == pytest.approx([0.0, 0.0], abs=1e-4)
    # Eight bits of a pedal.
    assert readings[-1][3:5] == pytest.approx([1.0, 0.5], abs=1.0 / 255.0)
    assert all(math.isnan(value) for reading in readings for value in reading[1:3])
    assert len(axes) == 4
    assert 0.0 < time.perf_counter() - at < 60.0


def test_a_wheel_is_asleep_until_it_has_been_turned(seen: dict[str, Seen]) -> None:
    told = seen["wakes"].result
    awake = [after for _, _, after in told]
    # SDL2 hides 409 of 32768 steps, then the axis jumps and stays awake.
    assert awake[:-1] == [False, False, False, False, True, True]
    assert [before for before, _, _ in told[:-1]] == [False, *awake[:-2]]
    shown = [-angle / HALF_RANGE * 32768.0 for _, angle, _ in told]
    # One step of 16 bits, which have no middle.
    assert shown == pytest.approx([0.0] * 4 + [420.0, 0.0, 7232.0], abs=1.5)
    assert told[-1][::2] == [False, False]  # opened anew, and not in its middle


def test_an_unplugged_wheel_is_lost_for_writer_and_reader(
    seen: dict[str, Seen],
) -> None:
    write, *reads, read_later, write_later = seen["loses"].result
    assert "takes no force" in write
    assert len(reads) == 2
    assert all(reason.endswith("was unplugged") for reason in reads)
    assert read_later.endswith("is closed")
    assert write_later.endswith("is closed")


def test_a_wheel_that_is_not_there_is_lost(seen: dict[str, Seen]) -> None:
    assert seen["opens_another"].result.endswith("is not plugged in; plug it in")


def test_an_emergency_stop_puts_no_force_on(seen: dict[str, Seen]) -> None:
    assert not [line for line in seen["stops"].log if line.startswith("effect")]
    assert not [line for line in seen["stops"].log if line.endswith("value=1")]


def test_signals_stay_pythons(seen: dict[str, Seen]) -> None:
    assert seen["refreshes"].result is False


def test_a_reading_and_a_torque_take_well_under_a_tick(seen: dict[str, Seen]) -> None:
    # Measured 35 µs; a tick of 960 Hz is 1.04 ms. Waiting for a processor is no work,
    # so that a loaded machine does not count; benchmarks judge the rare slow ones.
    assert seen["hurries"].result < 5e-4
