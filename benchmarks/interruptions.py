"""Studies and drives that are interrupted at random moments: what is lost of them?

    python -m benchmarks.interruptions [STUDIES [DRIVES]]

Runs a small study (2 participants, three conditions, 1.8 km, scripted intention)
whole, then again and again with SIGINT, SIGTERM or SIGKILL at STUDIES (30) random
moments, each time resumed, and compares every byte of what is there after each stop
and of the results. Then DRIVES (12) drives on the simulated wheel, with the network, of
which loop, network, server or watchdog is killed while the wheel pushes: the record
must be readable up to the last quarter of a second, the torque zero, and no process
left. Exit code 1 if anything is lost. POSIX alone has these signals. Commit and edit
nothing meanwhile: records name the revision, and it would stop.
"""

from __future__ import annotations

import multiprocessing
import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from multiprocessing.connection import Connection
from multiprocessing.shared_memory import SharedMemory
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.base.entry import source_hash
from costeer.devices.wheels.simulated import SpringHands
from costeer.records.record import read_record, read_stream
from costeer.runtime.drive import Drive, Listener
from costeer.runtime.frame import PLACE
from costeer.runtime.recorder import INTERVAL
from costeer.runtime.shared import close_shared, open_shared
from costeer.runtime.states import Loss, RunState
from costeer.study.locks import LOCK_FILE
from tests.runtime.rig import wheel_setup
from tests.runtime.test_processes import is_running
from tests.study.fakes import contents
from tests.waiting import wait_for

SEED = 1
ROOT = Path(__file__).parents[1]
STUDY = ("--participants", "2", "--conditions", "manual,strong-rapid,weak-gentle")
STUDY += ("--intention", "scripted", "--length", "1800", "--jobs", "1")
SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGKILL)
LONGEST_RUN = 1800.0
MOST_A_STUDY = 3
"""Interruptions of one study."""

VICTIMS = ("loop", "network", "server", "watchdog")
PUSH = 0.3
"""Torque under which a process is killed [N·m]."""

WRITING = 0.05
"""What a busy machine takes to write a batch, besides the quarter of a second [s]."""


# Studies


class Studies(NamedTuple):
    """What became of interrupted studies.

    Attributes:
        signals: Interruptions by signal.
        finished: Studies that were resumed to their end.
        changed: Files with another byte than in the study that ran whole.
        lost: Finished trials that were gone or simulated again.
        tracebacks: Runs that ended in one.
    """

    signals: Counter[str]
    finished: int
    changed: int
    lost: int
    tracebacks: int

    @property
    def is_sound(self) -> bool:
        """Whether nothing was lost."""
        return not (self.changed or self.lost or self.tracebacks)


def started(out: Path) -> subprocess.Popen[str]:
    """The study as a user starts it."""
    words = [sys.executable, "-m", "costeer", "study", "--out", str(out), *STUDY]
    told = subprocess.PIPE
    return subprocess.Popen(
        words, cwd=ROOT, stdout=subprocess.DEVNULL, stderr=told, text=True
    )


def finished_trials(out: Path) -> set[tuple[str, int, int]]:
    """Records with their names, places and times of writing."""
    facts = [(file.name, file.stat()) for file in (out / "records").glob("*.parquet")]
    return {(name, fact.st_ino, fact.st_mtime_ns) for name, fact in facts}


def changed_files(out: Path, whole: dict[str, bytes], is_finished: bool) -> list[str]:
    """Names of the files that are not as in the whole study.

    Args:
        out: A study.
        whole: What the whole study holds.
        is_finished: Whether a file may neither lack nor be half written.
    """
    found = contents(out)
    if not is_finished:
        found = {n: b for n, b in found.items() if not n.endswith((".tmp", LOCK_FILE))}
    names = found.keys() | whole.keys() if is_finished else found.keys()
    return sorted(name for name in names if found.get(name) != whole.get(name))


class Interrupter:
    """Runs studies and stops them.

    Args:
        folder: Of all studies.
        number: Interruptions to make.
    """

    def __init__(self, folder: Path, number: int) -> None:
        self._folder, self._number = folder, number
        self._draw = random.Random(SEED)
        self._signals: Counter[str] = Counter()
        self._finished = self._changed = self._lost = self._tracebacks = 0
        self._whole: dict[str, bytes] = {}

    def run(self) -> Studies:
        """Interrupt and resume until there were enough.

        Raises:
            SystemExit: If the sources were changed meanwhile.
        """
        sources = revision_now(), source_hash(ROOT / "src" / "costeer")
        longest = self._run_whole()
        while self._signals.total() < self._number:
            self._interrupt_one(self._folder / f"study-{self._finished}", longest)
            self._finished += 1
            if (revision_now(), source_hash(ROOT / "src" / "costeer")) != sources:
                raise SystemExit("the sources were changed meanwhile; run it again")
        return Studies(
            self._signals, self._finished, self._changed, self._lost, self._tracebacks
        )

    def _run_whole(self) -> float:
        """Run twice without interruption; return how long the second worked [s]."""
        for name in ("whole", "again"):  # the first may have to compile
            code, seconds = self._runs(self._folder / name, LONGEST_RUN)
            assert code == 0
            print(f"uninterrupted study: {seconds:.1f} s", flush=True)
            self._whole = self._whole or contents(self._folder / name)
            self._compare(self._folder / name, is_finished=True)
        return seconds

    def _interrupt_one(self, out: Path, longest: float) -> None:
        """Interrupt a study three times and let it end."""
        for _ in range(MOST_A_STUDY):
            # Trials take the first part of a run: squares are small more often.
            moment = longest * self._draw.random() ** 2
            if self._signals.total() == self._number or self._runs(out, moment)[0] == 0:
                break
            self._compare(out, is_finished=False)
            kept = len(finished_trials(out))
            print(
                f"{self._signals.total()} of {self._number}: stopped after "
                f"{moment:.1f} s of work, {kept} trials kept",
                flush=True,
            )
        code, seconds = self._runs(out, LONGEST_RUN)
        assert code == 0
        print(f"study {self._finished + 1} ended after {seconds:.1f} s", flush=True)
        self._compare(out, is_finished=True)

    def _compare(self, out: Path, is_finished: bool) -> None:
        """Count and name the files that are not as in the whole study."""
        names = changed_files(out, self._whole, is_finished)
        self._changed += len(names)
        if names:
            print(f"not as in the whole study: {', '.join(names)}", flush=True)

    def _runs(self, out: Path, moment: float) -> tuple[int, float]:
        """Run, and interrupt the work after a moment [s].

        Returns:
            Exit code, and seconds of work, from when the study holds its folder.
        """
        before, process = finished_trials(out), started(out)
        wait_until_held(out, process)
        began = time.monotonic()
        try:
            _, told = process.communicate(timeout=moment)
        except subprocess.TimeoutExpired:
            how = self._draw.choice(SIGNALS)
            before |= finished_trials(out)
            process.send_signal(how)
            _, told = process.communicate(timeout=LONGEST_RUN)
            if process.returncode != 0:  # else it had just come to its end
                self._signals[how.name] += 1
        self._lost += len(before - finished_trials(out))
        self._tracebacks += "Traceback" in told
        return process.returncode, time.monotonic() - began


def wait_until_held(out: Path, process: subprocess.Popen[str]) -> None:
    """Wait until a process works in a study's folder, or has ended."""
    while process.poll() is None:
        with suppress(OSError):
            if f"process {process.pid} " in (out / LOCK_FILE).read_text():
                return
        time.sleep(0.005)


def revision_now() -> str:
    """Revision of the checkout, which records name."""
    words = ["git", "rev-parse", "HEAD"]
    return subprocess.run(
        words, cwd=ROOT, capture_output=True, text=True, check=False
    ).stdout


# Drives


class Killed(NamedTuple):
    """What became of a drive.

    Attributes:
        victim: Who was killed.
        lack: What the record lacks at its end [s]; infinite if it cannot be read.
        until_zero: From the kill until the torque was zero [s].
        left: Processes that did not end.
    """

    victim: str
    lack: float
    until_zero: float
    left: int

    @property
    def is_sound(self) -> bool:
        """Whether nothing was lost."""
        return self.lack <= INTERVAL + WRITING and self.left == 0


def serve(record: Path, cell: str, link: Connection) -> None:
    """Be the server of a drive: tell the numbers of its processes, end at a word."""
    setup = wheel_setup(hands=SpringHands(amplitude=0.3), torque_cell=cell)

    def go_on(frame: NDArray[np.float64]) -> None:
        if frame[PLACE["run_state"]] == RunState.PAUSED:  # by a busy machine
            with suppress(ValueError):
                drive.send("acknowledge")
                drive.send("resume")

    listener = Listener(go_on, lambda marker: None)
    drive = Drive(setup._replace(intention="network"), record, listener)
    drive.start()
    drive.send("start")
    helpers = drive._helpers.processes
    numbers = {
        "server": os.getpid(),
        "loop": drive.pid,
        "watchdog": helpers[Loss.WATCHDOG].pid,
        "network": helpers[Loss.NETWORK].pid,
    }
    link.send((numbers, drive.shared.memory.name))
    link.recv()
    drive.stop()


@contextmanager
def torque_cell() -> Iterator[tuple[str, NDArray[np.float64]]]:
    """Memory that shows the torque of a simulated wheel to all processes."""
    memory = SharedMemory(create=True, size=8)
    cell: NDArray[np.float64] = np.ndarray(1, np.float64, memory.buf)
    cell[0] = 0.0
    try:
        yield memory.name, cell
    finally:
        del cell
        memory.unlink()


def kill_one(victim: str, draw: random.Random, folder: Path) -> Killed:
    """A drive of which one process is killed while the wheel pushes."""
    record = folder / "trial.parquet"
    context = multiprocessing.get_context("spawn")
    near, far = context.Pipe()
    with torque_cell() as (name, cell):
        server = context.Process(target=serve, args=(record, name, far))
        server.start()
        numbers, memory = near.recv()
        shared = open_shared(memory)
        wait_for(lambda: abs(cell[0]) > PUSH)
        time.sleep(draw.uniform(0.0, 2.0))
        wait_for(lambda: abs(cell[0]) > PUSH)
        _, frames = shared.frames.since(shared.frames.written - 1)
        began = time.perf_counter()
        os.kill(numbers[victim], signal.SIGKILL)
        if victim == "network":  # a drive goes on without it
            near.send("end")
        wait_for(lambda: cell[0] == 0.0)
        until_zero = time.perf_counter() - began
        if victim in ("loop", "watchdog"):
            time.sleep(0.5)  # whoever lives tells and keeps what happened
            near.send("end")
        server.join()
        left = ended(list(numbers.values()))
        assert cell[0] == 0.0
        close_shared(shared, unlink=victim == "server")
    lack = float(frames[-1, PLACE["time"]]) - kept_until(record)
    return Killed(victim, lack, until_zero, left)


def ended(processes: list[int]) -> int:
    """How many of the processes do not end by themselves."""
    with suppress(AssertionError):
        wait_for(lambda: not any(map(is_running, processes)))
    return sum(map(is_running, processes))


def kept_until(record: Path) -> float:
    """Time of the last row of a record or, where there is none, of its stream [s]."""
    try:
        if record.exists():
            return float(read_record(record).columns["time"][-1])
        return float(read_stream(record.with_suffix(".arrow")).columns["time"][-1])
    except (OSError, ValueError) as error:
        print(f"unreadable: {error}")
        return -np.inf


def tell_studies(number: int) -> bool:
    """Print what became of interrupted studies; return whether all is sound."""
    with tempfile.TemporaryDirectory() as place:
        found = Interrupter(Path(place), number).run()
    by_signal = ", ".join(f"{n} {name}" for name, n in sorted(found.signals.items()))
    print(
        f"studies: {found.signals.total()} interruptions ({by_signal}) of "
        f"{found.finished} studies; {found.changed} files changed, {found.lost} "
        f"finished trials lost, {found.tracebacks} tracebacks",
        flush=True,
    )
    return found.is_sound


def tell_drives(number: int) -> bool:
    """Print what became of killed drives; return whether all is sound."""
    draw, found = random.Random(SEED), []
    for k in range(number):
        with tempfile.TemporaryDirectory() as place:
            found.append(kill_one(VICTIMS[k % len(VICTIMS)], draw, Path(place)))
    for victim in VICTIMS[:number]:
        those = [drive for drive in found if drive.victim == victim]
        print(
            f"{victim} killed in {len(those)} drives: the record lacks at most "
            f"{max(each.lack for each in those):.3f} s, torque zero after at most "
            f"{max(each.until_zero for each in those):.3f} s, "
            f"{sum(each.left for each in those)} processes left"
        )
    return all(drive.is_sound for drive in found)


def main() -> int:
    """Print what was lost; return the exit code."""
    words = sys.argv[1:]
    if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:  # as a shell's background has
        signal.signal(signal.SIGINT, signal.default_int_handler)
    num_studies, num_drives = [*map(int, words), *(30, 12)[len(words) :]]
    is_sound = [tell_studies(num_studies)] if num_studies else []
    is_sound += [tell_drives(num_drives)] if num_drives else []
    return int(not all(is_sound))


if __name__ == "__main__":
    sys.exit(main())
