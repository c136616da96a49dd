"""`costeer drive`: what cannot begin is refused before anything is started."""

from __future__ import annotations

import itertools
import os
import re
import signal
import socket
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import typer

from costeer.cli import drive as command
from costeer.cli import main
from costeer.export.markers import markers_of
from costeer.records.record import read_record
from costeer.runtime.frame import FRAME_COLUMNS, PLACE
from costeer.runtime.markers import Marker
from costeer.runtime.states import RunState
from costeer.web.drive import DriveOnPages, PageOptions
from tests.runtime.rig import drive_setup
from tests.waiting import PATIENCE


@pytest.fixture(autouse=True)
def _nothing_starts(monkeypatch: pytest.MonkeyPatch) -> None:
    def start(*_: object) -> None:
        pytest.fail("the drive was started")

    monkeypatch.setattr("costeer.runtime.drive.Drive.start", start)


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["--condition", "strongest"], "condition 'strongest'"),
        (["--method", "magic"], "method 'magic' is not known"),
        (["--intention", "mind"], "intention 'mind' is not known"),
        (["--car", "tank"], "car 'tank' is not known"),
        (["--speed", "300km/h"], "speed is"),
        (["--length", "5"], "length is 5"),
        (["--wheel", "hands"], "--wheel is 'hands'"),
        (["--head", "third-eye"], "--head is 'third-eye'"),
        (["--participant", "Jane Doe"], "pseudonym"),
        (["--record", "me.csv"], "ends in .parquet"),
        (["--port", "70000"], "port is 70000"),
        (["--host", "no.such.host.example"], "is no address of this computer"),
    ],
)
def test_bad_option_is_refused_in_one_line(
    capfd: pytest.CaptureFixture[str], words: list[str], told: str
) -> None:
    usual = ["drive", "--wheel", "keyboard", "--no-browser", "--port", "0"]
    assert main([*usual, *words]) == 2
    error = capfd.readouterr().err
    assert told in error
    assert error.count("\n") == 1


def test_record_that_is_there_is_not_written_over(
    capfd: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    record = tmp_path / "me.parquet"
    record.write_bytes(b"driven")
    assert main(["drive", "--wheel", "keyboard", "--record", str(record)]) == 2
    assert "choose another --record" in capfd.readouterr().err
    assert record.read_bytes() == b"driven"


def test_port_that_is_taken_is_told_before_anything_is_started(
    capfd: pytest.CaptureFixture[str],
) -> None:
    with socket.socket() as other:
        other.bind(("127.0.0.1", 0))
        other.listen()
        port = str(other.getsockname()[1])
        assert main(["drive", "--wheel", "keyboard", "--port", port]) == 2
    assert f"port {port} is taken" in capfd.readouterr().err


def test_frames_and_markers_go_to_lsl_with_the_time_of_their_making(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    sent: list[Any] = []

    class Outlet:
        """Takes down what it is given."""

        def __init__(self, columns: dict[str, str]) -> None:
            assert list(columns) == list(FRAME_COLUMNS)
            assert columns["driver_torque"] == "N·m"

        def push(self, sample: list[float], when: float) -> None:
            """Take a sample."""
            sent.append((sample, when))

        def mark(self, marker: Marker) -> None:
            """Take a marker."""
            sent.append(marker)

    monkeypatch.setattr("costeer.export.lsl.TrialOutlet", Outlet)
    session = DriveOnPages(drive_setup(), None, PageOptions())
    with monkeypatch.context() as clocks:
        clocks.setattr("time.perf_counter", lambda: 100.0)
        clocks.setattr("costeer.export.lsl.lsl_clock", lambda: 105.0)
        command.send_to_lsl(session)
    session._tell(np.full(len(FRAME_COLUMNS), 2.0))
    session._mark(Marker("paused", "driver"))
    session.stop()
    assert sent[0][0] == [2.0] * len(FRAME_COLUMNS)
    assert sent[0][1] == 7.0
    assert sent[1] == Marker("paused", "driver")


@pytest.mark.slow
@pytest.mark.usefixtures("compiled_drive")
@pytest.mark.skipif(os.name != "posix", reason="there is no such signal")
@pytest.mark.parametrize("how", [signal.SIGINT, signal.SIGTERM], ids=["Ctrl-C", "term"])
def test_stopped_command_leaves_a_whole_record_and_no_process(
    tmp_path: Path, how: signal.Signals
) -> None:
    record = tmp_path / "me.parquet"
    words = ["drive", "--wheel", "keyboard", "--intention", "off", "--no-browser"]
    arguments = [*words, "--port", "0", "--record", str(record)]
    with subprocess.Popen(
        [sys.executable, "-m", "costeer", *arguments],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    ) as process:
        assert process.stdout is not None
        address = process.stdout.readline().split()[-1]
        drive_a_while(address)
        process.send_signal(how)
        time.sleep(0.05)
        process.send_signal(how)  # who is impatient loses nothing
        out, err = process.communicate(timeout=PATIENCE)
    assert process.returncode == 0
    assert "Traceback" not in err
    assert "leaked" not in err
    assert out.endswith(f"{record}\n")
    kept = read_record(record)
    assert kept.columns["time"][-1] > 0.5
    ends = [marker[:2] for marker in markers_of(kept.metadata)][-1]
    assert ends == ("ended", "server")  # no fault of a page that closed with its server


@pytest.mark.slow
@pytest.mark.usefixtures("compiled_drive")
@pytest.mark.skipif(os.name != "posix", reason="there is no such signal")
@pytest.mark.parametrize("after", [0.5, 2.0, 4.0])
def test_stop_while_it_starts_is_told_in_one_line(after: float) -> None:
    words = ["drive", "--wheel", "keyboard", "--no-browser", "--port", "0"]
    with subprocess.Popen(
        [sys.executable, "-m", "costeer", *words],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    ) as process:
        assert process.stderr is not None
        process.stderr.readline()  # "starting"
        time.sleep(after)
        os.killpg(process.pid, signal.SIGINT)  # as a terminal does
        _, told = process.communicate(timeout=PATIENCE)
    # A busy machine says that it was late.
    told_anyway = re.compile("real-time process|control steps held")
    lines = [line for line in told.splitlines() if not told_anyway.search(line)]
    assert lines in (["costeer: stopped"], [])  # none if it had started by then


def drive_a_while(address: str) -> None:
    """Be the page: start, and say a word at every frame until a second has passed.

    On a busy machine the page may fall silent, which pauses the drive: it goes on.
    """
    from websockets.sync.client import connect

    url = address.replace("http", "ws", 1) + "ws"
    with connect(url, origin=address.rstrip("/")) as page:  # type: ignore[arg-type]  # a plain text is an origin
        page.recv(timeout=PATIENCE)
        page.send('{"type":"start"}')
        for sequence in itertools.count():
            page.send(
                f'{{"type":"input","sequence":{sequence},"steer":0,'
                '"accelerator":0,"brake":0}'
            )
            if isinstance(told := page.recv(timeout=PATIENCE), str):
                continue
            frame = np.frombuffer(told)[-len(FRAME_COLUMNS) :]
            if frame[PLACE["time"]] > 1.0:
                return
            if frame[PLACE["run_state"]] == RunState.PAUSED and sequence % 60 == 0:
                page.send('{"type":"acknowledge"}')
                page.send('{"type":"resume"}')


def test_what_could_not_be_kept_is_told_and_makes_the_command_fail(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    session = DriveOnPages(drive_setup(), None, PageOptions())
    session.drive._keeper.unkept.append("no space; what was driven is in me.arrow")
    with pytest.raises(typer.Exit) as end:
        command.tell_end(session)
    session.stop()
    assert end.value.exit_code == 1
    assert "me.arrow" in capsys.readouterr().err
