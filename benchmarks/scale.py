"""Many drivers: memory, killed workers, and the time a thousand of them take.

    python -m benchmarks.scale memory [DRIVERS ...]
    python -m benchmarks.scale kills [KILLS]
    python -m benchmarks.scale whole [DRIVERS]
    python -m benchmarks.scale growth FIGURE.svg

`memory` runs the study without records for 50 and 200 drivers (one overtaking event,
two conditions, scripted intention) and prints the largest memory of the process, which
must not grow with their number. `kills` kills a worker of `local:2` at 20 random
moments and compares every byte with a study that nobody disturbed; exit code 1 if one
differs.
`whole` is the study of the paper with 1,000 drivers: 7 conditions, 8 km, the network;
fewer tell what a driver takes. `growth` runs one condition with the network for 1 to
10,000 drivers over 0.8 km, and for 100 drivers over 0.8 to 80 km, prints time and
memory, and writes the figure of docs/scale.md. Edit nothing meanwhile: workers would be
refused.
"""

from __future__ import annotations

import os
import platform
import random
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NamedTuple

from matplotlib.figure import Figure

from costeer.pages.style import (
    FAINT,
    FULL_WIDTH_MM,
    INK,
    RULE,
    Margins,
    new_figure,
    panels,
    styled,
    svg_text,
)
from costeer.scale.cluster import workers
from costeer.study import run as study_run
from costeer.study.batches import TOGETHER_FROM
from costeer.study.configuration import StudySettings
from costeer.study.run import Scale, run_study
from costeer.study.trials import TrialDone
from tests.study.fakes import contents

DRIVERS, LENGTHS = (1, 10, 100, 1000, 10_000), (800, 8_000, 80_000)
SEED = 1
SHORT = ("--conditions", "manual,weak-gentle", "--intention", "scripted")
SHORT += ("--length", "1800")
TRIALS_A_KILL = 10

CHILD = """
import resource, sys
from costeer.cli import main
code = main(sys.argv[1:])
print("peak", resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)
sys.exit(code)
"""
"""Runs a command and tells the largest memory it had [kB]."""


class Ran(NamedTuple):
    """A study that was run in a process of its own.

    Attributes:
        seconds: From start to end [s].
        peak: Largest memory [MB].
        told: What it printed.
    """

    seconds: float
    peak: float
    told: list[str]


def ran(out: Path, drivers: int, *words: str) -> Ran:
    """Run a study without records or report."""
    command = ["study", "--out", str(out), "--participants", str(drivers)]
    command += ["--no-records", "--no-report", *words]
    begun = time.monotonic()
    done = subprocess.run(
        [sys.executable, "-c", CHILD, *command],
        stdout=subprocess.PIPE,
        text=True,
        check=True,
    )
    seconds = time.monotonic() - begun
    *told, last = done.stdout.splitlines()
    return Ran(seconds, int(last.split()[1]) / 1024.0, told)


def memory(numbers: list[int]) -> int:
    """Print the largest memory for each number of drivers."""
    with tempfile.TemporaryDirectory() as folder:
        ran(Path(folder) / "first", 1, *SHORT)  # compiles
        for number in numbers:
            found = ran(Path(folder) / str(number), number, *SHORT)
            print(
                f"{number} drivers, {2 * number} trials: {found.seconds:.0f} s, "
                f"peak {found.peak:.0f} MB",
                flush=True,
            )
    return 0


def worker_pids(engine: Any) -> list[int]:  # Any: of Dask
    """Processes of the workers that are up."""
    nannies = engine.client.cluster.workers.values()
    up = [each for each in nannies if each.status.name == "running"]
    return [each.process.pid for each in up if each.process.is_alive()]


def kills(number: int) -> int:
    """Kill workers, and say whether a byte is another."""
    settings = StudySettings(
        participants=max(2, number * TRIALS_A_KILL // 2),
        conditions=("manual", "weak-gentle"),
        intention="scripted",
        length=600.0,
    )
    num_trials = 2 * settings.participants
    draw = random.Random(SEED)
    moments = set(draw.sample(range(1, num_trials - TRIALS_A_KILL), number))
    with tempfile.TemporaryDirectory() as folder:
        whole, out = Path(folder) / "whole", Path(folder) / "killed"
        run_study(whole, settings, report=None)
        killed = _run_killed(out, settings, moments, draw)
        one, two = contents(whole), contents(out)
    names = one.keys() | two.keys()
    changed = [name for name in names if one.get(name) != two.get(name)]
    print(
        f"{killed} kills in {num_trials} trials: {len(one)} files, {len(changed)} of "
        f"them lost or with another byte",
        *sorted(changed)[:3],
    )
    return 1 if changed or killed < number else 0


def _run_killed(
    out: Path, settings: StudySettings, moments: set[int], draw: random.Random
) -> int:
    """Run a study on two workers and kill one at each of the moments; count them."""
    seen = killed = 0
    with workers(None, "local:2") as engine:

        @contextmanager
        def given(*_: object) -> Iterator[Any]:
            yield engine

        def kill_some(_: TrialDone) -> None:
            nonlocal seen, killed
            seen += 1
            pids = worker_pids(engine)
            if seen in moments and pids:
                os.kill(draw.choice(pids), signal.SIGKILL)
                killed += 1

        usual, study_run.workers = study_run.workers, given
        try:
            scale = Scale(cluster="local:2")
            run_study(out, settings, report=None, progress=kill_some, scale=scale)
        finally:
            study_run.workers = usual
    return killed


def whole(drivers: int) -> int:
    """Print how long the study of the paper takes with so many drivers."""
    with tempfile.TemporaryDirectory() as folder:
        found = ran(Path(folder) / "study", drivers)
    print("\n".join(found.told[:-1]))
    print(
        f"{drivers} drivers, {7 * drivers} trials of 8 km: {found.seconds:.0f} s, "
        f"{found.seconds / drivers:.2f} s a driver, peak {found.peak:.0f} MB"
    )
    return 0


class Grown(NamedTuple):
    """One point of a figure.

    Attributes:
        kilometres: Driven in all [km].
        seconds: Of the whole command [s].
        peak: Its largest memory [MB].
    """

    kilometres: float
    seconds: float
    peak: float


def growth(file: Path) -> int:
    """Print and draw how time and memory grow."""
    series = {
        "drivers, 0.8 km each": [(number, 800) for number in DRIVERS],
        "length, 100 drivers": [(100, length) for length in LENGTHS],
    }
    found: dict[str, list[Grown]] = {}
    with tempfile.TemporaryDirectory() as folder:
        for number in (1, TOGETHER_FROM):  # compiles
            ran(Path(folder) / str(number), number, *_grown(200))
        for name, points in series.items():
            for drivers, length in points:
                out = Path(folder) / f"{drivers}-{length}"
                each = ran(out, drivers, *_grown(length))
                point = Grown(drivers * length / 1e3, each.seconds, each.peak)
                found.setdefault(name, []).append(point)
                print(
                    f"{drivers} drivers, {length / 1e3:g} km: {point.seconds:.1f} s, "
                    f"peak {point.peak:.0f} MB",
                    flush=True,
                )
    with styled():
        text = svg_text(drawn(found), "growth", "Time and memory of a study")
    file.write_text(text, "utf-8")
    return 0


def _grown(length: int) -> tuple[str, ...]:
    return "--conditions", "strong-normal", "--length", str(length)


def drawn(found: dict[str, list[Grown]]) -> Figure:
    """Time and memory against the kilometres that are driven."""
    figure = new_figure(FULL_WIDTH_MM, 70.0)
    (row,) = panels(figure, 1, 2, Margins(left=14.0, top=10.0, right=4.0))
    looks = zip(found.items(), (INK, FAINT), ("o", "s"), strict=True)
    for (name, points), colour, mark in looks:
        driven = [point.kilometres for point in points]
        for axes, values in zip(
            row, ([p.seconds for p in points], [p.peak for p in points]), strict=True
        ):
            axes.plot(driven, values, mark, color=colour, label=name)
    last = found[next(iter(found))][-1]
    least = min(point.kilometres for point in found[next(iter(found))])
    begin = last.kilometres / last.seconds
    line = ([begin, last.kilometres], [1.0, last.seconds])
    row[0].plot(*line, "-", color=RULE, label="proportional")
    for axes, label in zip(row, ("time [s]", "largest memory [MB]"), strict=True):
        axes.set(xscale="log", xlabel="driven [km]", ylabel=label)
        axes.set_xlim(least / 2.0, 2.0 * last.kilometres)
    row[0].set_yscale("log")
    row[1].set_ylim(0.0, None)
    row[0].legend(loc="upper left")
    return figure


def main(words: list[str]) -> int:
    """Run what the words name."""
    kind = words[0] if words else ""
    numbers = [int(word) for word in words[1:] if word.isdigit()]
    print(
        f"{platform.machine()}, {os.cpu_count()} cores, load {os.getloadavg()[0]:.1f}"
    )
    if kind == "memory":
        return memory(numbers or [50, 200])
    if kind == "kills":
        return kills(*(numbers or [20]))
    if kind == "whole":
        return whole(*(numbers or [1000]))
    if kind == "growth":
        return growth(Path(words[1]))
    print(__doc__)
    return 2


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
