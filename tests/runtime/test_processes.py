"""The processes of a drive together: they keep time, and none can take another down."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from costeer.devices.head.calibration import HeadCalibration
from costeer.devices.head.source import HeadDescription
from costeer.devices.wheels.simulated import SpringHands, simulated_description
from costeer.export.markers import markers_of
from costeer.records.record import read_record, read_stream
from costeer.runtime.drive import Drive, Listener
from costeer.runtime.frame import PLACE
from costeer.runtime.markers import Marker, told
from costeer.runtime.setup import DriveSetup
from costeer.runtime.states import Fault, Loss, RunState
from tests.runtime.rig import drive_setup, wheel_setup
from tests.waiting import PATIENCE, wait_for

pytestmark = pytest.mark.usefixtures("compiled_drive")
needs_posix = pytest.mark.skipif(os.name != "posix", reason="there are no such signals")


class Kept:
    """What a drive has told."""

    def __init__(self) -> None:
        self.frames: list[NDArray[np.float64]] = []
        self.markers: list[Marker] = []

    def column(self, name: str) -> NDArray[np.float64]:
        """A column of all frames so far."""
        return np.array([frame[PLACE[name]] for frame in self.frames])

    def kinds(self) -> list[object]:
        """Kinds of all markers so far."""
        return [marker.kind for marker in self.markers]


def go_on(drive: Drive, kept: Kept) -> None:
    """Resume a drive that a busy machine has paused."""
    if kept.frames and kept.frames[-1][PLACE["run_state"]] == RunState.PAUSED:
        with suppress(ValueError):
            drive.send("acknowledge")
            drive.send("resume")


def has_verdicts(kept: Kept) -> bool:
    """Whether the newest frames hold a probability."""
    return bool(np.isfinite(kept.column("crossing_probability")[-10:]).all())


Begin = Callable[[DriveSetup, Path | None], tuple[Drive, Kept]]


@pytest.fixture
def begin() -> Iterator[Begin]:
    drives: list[Drive] = []

    def make(setup: DriveSetup, record: Path | None) -> tuple[Drive, Kept]:
        kept = Kept()
        listener = Listener(
            lambda frame: kept.frames.append(frame.copy()), kept.markers.append
        )
        drives.append(Drive(setup, record, listener))
        drives[-1].start()
        return drives[-1], kept

    yield make
    for drive in drives:
        drive.stop()


@pytest.mark.slow
def test_change_goes_from_the_command_to_the_record_with_all_its_fields(
    begin: Begin, tmp_path: Path
) -> None:
    drive, kept = begin(drive_setup("strong-normal"), tmp_path / "trial.parquet")
    drive.send("start")
    wait_for(lambda: kept.frames and kept.column("time")[-1] > 0.5)
    drive.send("set", "method", "manual")
    drive.send("set", "preview_time", 1.75)
    wait_for(lambda: len(kept.markers) == 4)
    drive.stop()
    markers = markers_of(read_record(drive.kept[0]).metadata)
    assert markers == kept.markers
    assert [marker[:5] for marker in markers] == [
        ("started", "", None, None, ""),
        ("method", "", "ibhs", "manual", ""),
        ("parameter", "strength_factor", 1.0, 0.0, "-"),
        ("parameter", "preview_time", 1.5, 1.75, "s"),
        ("ended", "server", None, None, ""),
    ]
    assert 0.5 < markers[1].time <= markers[3].time < PATIENCE


@pytest.mark.slow
def test_drive_keeps_to_the_clock_with_verdicts_and_leaves_its_record(
    begin: Begin, tmp_path: Path
) -> None:
    setup = drive_setup()._replace(intention="network", needs_page=True)
    drive, kept = begin(setup, tmp_path / "trial.parquet")
    drive.press(1, 0.0, 0.0, 0.0)
    drive.send("start")
    wait_for(lambda: kept.frames)

    def second_is_a_second() -> bool:
        began, simulated = time.monotonic(), kept.column("time")[-1]
        while time.monotonic() - began < 1.0:
            assert page_is_there()
            time.sleep(0.05)
        passed = kept.column("time")[-1] - simulated
        return passed == pytest.approx(time.monotonic() - began, abs=0.1)

    def page_is_there() -> bool:
        drive.press(7, 0.0, 0.0, 0.0)
        go_on(drive, kept)
        return True

    # Fixed steps that catch up; only what a busy machine holds up for longer than
    # `LONGEST_BACKLOG` is lost, so that it may need several seconds for one.
    wait_for(second_is_a_second)
    wait_for(lambda: page_is_there() and has_verdicts(kept))
    assert kept.column("input_sequence")[-1] == 7.0
    simulated = kept.column("time")[-1]
    drive.stop()
    assert drive.kept == [tmp_path / "trial.parquet"]
    columns = read_record(drive.kept[0]).columns
    assert np.allclose(np.diff(columns["time"]), 1 / 60)
    assert columns["time"][-1] >= simulated - 0.05
    assert np.isnan(columns["crossing_probability"][:170]).all()  # window not full
    assert (tmp_path / "trial.wheel.parquet").exists()
    assert [kept.kinds()[0], kept.kinds()[-1]] == ["started", "ended"]


@pytest.mark.slow
@needs_posix
@pytest.mark.parametrize("how", ["SIGKILL", "SIGSTOP", "SIGHUP"])
def test_wheel_is_let_go_and_the_record_kept_when_the_loop_dies_or_sticks(
    begin: Begin,
    torque_cell: tuple[str, NDArray[np.float64]],
    tmp_path: Path,
    how: str,
) -> None:
    name, cell = torque_cell
    setup = wheel_setup(
        "strong-normal", hands=SpringHands(amplitude=0.3), torque_cell=name
    )
    drive, kept = begin(setup, tmp_path / "trial.parquet")
    drive.send("start")
    wait_for(lambda: go_on(drive, kept) or abs(cell[0]) > 0.3)
    kept.markers.clear()
    os.kill(drive.pid, getattr(signal, how))
    # Within 100 ms but for what a busy machine adds: tests/runtime/test_watchdog.py.
    wait_for(lambda: cell[0] == 0.0)
    wait_for(lambda: "fault" in kept.kinds())
    assert kept.column("fault")[-1] == Fault.LOOP_GONE
    wait_for(lambda: drive.kept)
    driven = read_record(drive.kept[0]).columns["time"]
    assert driven[-1] > kept.column("time")[-1] - 0.3
    time.sleep(0.05)
    assert cell[0] == 0.0


@pytest.mark.slow
@needs_posix
def test_nobody_drives_on_when_the_watchdog_is_gone(begin: Begin) -> None:
    drive, kept = begin(drive_setup(), None)
    drive.send("start")
    wait_for(lambda: "started" in kept.kinds())
    os.kill(int(drive._helpers.processes[Loss.WATCHDOG].pid or 0), signal.SIGKILL)
    wait_for(lambda: {"lost", "fault"} <= set(kept.kinds()))
    wait_for(lambda: kept.column("fault")[-1] == Fault.UNWATCHED)
    assert kept.column("run_state")[-1] == RunState.PAUSED
    assert drive.losses == [Loss.WATCHDOG]
    with pytest.raises(ValueError, match="nobody watches the steering wheel"):
        drive.send("resume")


@pytest.mark.slow
@needs_posix
def test_lost_network_is_told_as_long_as_it_lasts_and_marked_in_the_record(
    begin: Begin, tmp_path: Path
) -> None:
    setup = drive_setup()._replace(intention="network")
    drive, kept = begin(setup, tmp_path / "trial.parquet")
    drive.send("start")
    wait_for(lambda: kept.frames and kept.column("time")[-1] > 0.3)
    assert drive.losses == []
    os.kill(int(drive._helpers.processes[Loss.NETWORK].pid or 0), signal.SIGKILL)
    wait_for(lambda: drive.losses == [Loss.NETWORK])
    drive.stop()
    markers = markers_of(read_record(drive.kept[0]).metadata)
    (lost,) = [marker for marker in markers if marker.kind == "lost"]
    assert lost.name == "network"
    assert lost.time > 0.2
    assert "no lane change is read" in told(lost)


@pytest.mark.slow
@needs_posix
@pytest.mark.parametrize("how", ["SIGTERM", "SIGHUP"])
def test_drive_ends_although_its_helpers_were_ended_first(
    begin: Begin, how: str
) -> None:
    # As when a terminal is closed: all processes get the signal at once. An event of
    # multiprocessing would wait for ever for the one that died waiting for it.
    head = HeadCalibration("1", HeadDescription("webcam", "no such file.mp4"))
    drive, kept = begin(drive_setup()._replace(head=head), None)
    assert drive.losses == [Loss.CAMERA]
    assert [marker[:2] for marker in kept.markers] == [("lost", "camera")]
    drive.is_ending = True
    tracker = drive._helpers.processes[Loss.HEAD]
    os.kill(int(tracker.pid or 0), getattr(signal, how))
    os.kill(drive.pid, getattr(signal, how))
    began = time.monotonic()
    drive.stop()
    assert time.monotonic() - began < PATIENCE
    assert not tracker.is_alive()
    assert "fault" not in kept.kinds()


@pytest.mark.slow
def test_wheel_that_is_not_there_is_told_in_its_own_words(begin: Begin) -> None:
    setup = wheel_setup()
    broken = simulated_description()._replace(address='{"speed": 1}')
    with pytest.raises(ValueError, match="speed"):
        begin(setup._replace(wheel=broken), None)


SERVER = """
import sys, time
from pathlib import Path
from costeer.runtime.drive import Drive, Listener
from costeer.runtime.frame import PLACE
from tests.runtime.rig import drive_setup

def tell(frame):
    if frame[PLACE["time"]] > 1.5:
        print(drive.pid, flush=True)

if __name__ == "__main__":
    drive = Drive(drive_setup(), Path(sys.argv[1]), Listener(tell, lambda marker: None))
    drive.start()
    drive.send("start")
    time.sleep(600)
"""


@pytest.mark.slow
@needs_posix
def test_killed_server_leaves_the_stream_and_the_loop_ends_by_itself(
    tmp_path: Path,
) -> None:
    script = tmp_path / "server.py"
    script.write_text(SERVER, encoding="utf-8")
    path = tmp_path / "trial.parquet"
    command = [sys.executable, str(script), str(path)]
    paths = [str(Path.cwd()), *sys.path]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(paths)}
    with subprocess.Popen(
        command, stdout=subprocess.PIPE, text=True, env=environment
    ) as server:
        assert server.stdout is not None
        loop = int(server.stdout.readline())
        server.send_signal(signal.SIGKILL)
    assert read_stream(path.with_suffix(".arrow")).columns["time"][-1] > 1.0
    wait_for(lambda: not is_running(loop))


def is_running(process: int) -> bool:
    """Whether a process of that number is alive; one that waits to be buried is not."""
    try:
        state = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0]
    except (FileNotFoundError, ProcessLookupError):
        return False
    return state != "Z"
