"""A steering wheel as the kernel shows one, for the real SDL2: fake_kernel.c, a FIFO.

Scenarios are functions of a test file. They run one after the other in a process of
their own, with the fake kernel loaded before libc.
"""

from __future__ import annotations

import importlib
import json
import os
import re
import shutil
import struct
import subprocess
import sys
from pathlib import Path
from typing import Any, NamedTuple

import coverage

from costeer.devices.wheels.calibration import WheelCalibration

ROOT = Path(__file__).parents[3]
SOURCE = Path(__file__).with_name("fake_kernel.c")
NEXT = "next scenario\n"
EVENT = struct.Struct("@llHHi")
KEY, AXIS = 0x01, 0x03
FIRST_BUTTON = 0x120
STEERING, CLUTCH, ACCELERATOR, BRAKE = 0, 1, 2, 5  # as evdev numbers the axes

CALIBRATION = WheelCalibration(
    identity="046d-c24f",
    angle_sign=-1.0,
    torque_curve=((0.0, 0.0), (1.0, 2.0)),
    accelerator_axis=2,
    accelerator_sign=-1.0,
    brake_axis=3,
    brake_sign=-1.0,
)

RUNS_HERE = (
    sys.platform == "linux"
    and shutil.which("gcc") is not None
    # Where the system has event devices SDL2 asks udev, and the fake could meet a real
    # wheel.
    and not Path("/dev/input").exists()
)
REASON = "needs Linux with gcc and without input devices of its own"


class Seen(NamedTuple):
    """What came of a scenario: its result, and what the kernel was told."""

    result: Any  # what JSON brought back
    log: list[str]

    def effects(self, name: str) -> list[int]:
        """A number of every effect that was sent, in order."""
        lines = [line for line in self.log if line.startswith("effect")]
        found = [re.search(rf"\b{name}=(\S+)", line) for line in lines]
        return [int(match[1], 0) for match in found if match]


def played(module: str, scenarios: tuple[str, ...], folder: Path) -> dict[str, Seen]:
    """Run scenarios of a module with the fake kernel; fail if one fails.

    Args:
        module: Full name of the test file.
        scenarios: Names of its functions, in order.
        folder: Empty, for the device and the log.
    """
    node, log = folder / "event0", folder / "log"
    os.mkfifo(node)
    log.touch()
    settings = {
        "LD_PRELOAD": str(compiled(folder)),
        "SDL_JOYSTICK_DEVICE": "/dev/input/event0",
        "FAKE_WHEEL_NODE": str(node),
        "FAKE_WHEEL_LOG": str(log),
        "FAKE_WHEEL_AT": str(folder / "at"),
        "FAKE_WHEEL_GONE": str(folder / "gone"),
    }
    if coverage.Coverage.current() is not None:
        settings["COVERAGE_PROCESS_START"] = str(ROOT / "pyproject.toml")
    code = f"from {__name__} import told; told({module!r}, {scenarios!r})"
    done = subprocess.run(
        [sys.executable, "-W", "error", "-c", code],
        cwd=ROOT,
        env={**os.environ, **settings},
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    parts = log.read_text().split(NEXT)[1:]
    results = json.loads(done.stdout.splitlines()[-1])
    return {
        name: Seen(result, part.splitlines())
        for (name, result), part in zip(results.items(), parts, strict=True)
    }


def compiled(folder: Path) -> Path:
    """The fake kernel as a library in a folder."""
    library = folder / "fake_kernel.so"
    words = ["gcc", "-shared", "-fPIC", "-o", str(library), str(SOURCE), "-ldl"]
    subprocess.run(words, check=True, capture_output=True, text=True)
    return library


def told(module: str, scenarios: tuple[str, ...]) -> None:
    """Hold the FIFO open, without which SDL2 would wait for ever; tell the results."""
    os.open(os.environ["FAKE_WHEEL_NODE"], os.O_RDWR)
    found = importlib.import_module(module)
    results = {}
    for name in scenarios:
        with Path(os.environ["FAKE_WHEEL_LOG"]).open("a") as log:
            log.write(NEXT)
        results[name] = getattr(found, name)()
    print(json.dumps(results))


def moved(kind: int, number: int, value: int) -> None:
    """Have the kernel say that an axis or a button changed."""
    report = EVENT.pack(0, 0, kind, number, value) + EVENT.pack(0, 0, 0, 0, 0)
    with Path(os.environ["FAKE_WHEEL_NODE"]).open("wb", buffering=0) as node:
        node.write(report)


def stands_at(value: int) -> None:
    """Have the kernel say that the steering is at a value when it is opened next."""
    Path(os.environ["FAKE_WHEEL_AT"]).write_text(str(value))


def unplugged() -> None:
    """Have the kernel say that the device is gone."""
    Path(os.environ["FAKE_WHEEL_GONE"]).touch()
