"""Settings of every test: order, random examples, shapes, compilation, signals."""

from __future__ import annotations

import gc
import importlib
import os
import random
import re
import signal
from collections import defaultdict
from contextlib import suppress
from pathlib import Path
from typing import Any

import pytest
from filelock import FileLock
from hypothesis import settings
from numba.core.caching import NullCache
from numba.core.compiler_lock import global_compiler_lock
from numba.core.dispatcher import Dispatcher

from costeer.base.entry import cache_folder
from tests.shapes import check_shapes

# No deadline: the first call of a compiled function takes seconds.
# Fifty examples find what a hundred do, given that every run draws others; tracing for
# coverage makes each of them three times as slow.
settings.register_profile("default", deadline=None, max_examples=50)
settings.register_profile("ci", deadline=None, max_examples=50, derandomize=True)
settings.register_profile("thorough", deadline=None, max_examples=1000)
usual = "ci" if os.environ.get("CI") else "default"
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", usual))

check_shapes()

# What is imported and collected stays: looking through it for what is garbage, again
# and again, takes a tenth of the time of all tests.
gc.disable()

# A shell has what runs in its background ignore Ctrl-C, and so would the commands that
# tests start and then stop by it.
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption(
        "--shuffle",
        type=int,
        metavar="SEED",
        help="run files, and the tests of each, in the random order of this seed",
    )


def pytest_report_header(config: pytest.Config) -> str:
    seed = config.getoption("--shuffle")
    return "order: as written" if seed is None else f"order: --shuffle {seed}"


def pytest_sessionstart(session: pytest.Session) -> None:
    """Have each worker begin to import at another file.

    Pytest rewrites the asserts of a file that nobody has imported yet, and leaves the
    bytecode to the other workers: half a minute for each if all begin with the same.
    """
    worker = getattr(session.config, "workerinput", None)
    folder = Path(__file__).parent
    if worker is None or [Path(each).name for each in session.config.args] != ["tests"]:
        return
    files = sorted(folder.rglob("test_*.py"))
    start = len(files) * int(worker["workerid"][2:]) // worker["workercount"]
    for file in files[start:] + files[:start]:
        parts = file.relative_to(folder.parent).with_suffix("").parts
        with suppress(Exception, pytest.skip.Exception):  # the collection tells of it
            importlib.import_module(".".join(parts))


# While one worker compiles for these files, the other has work that needs no loop.
COMPILE = ("closed_loop/test_mirror.py", "runtime/test_driving_wheel.py")
NEED_NO_LOOP = ("architecture", "devices", "export", "records", "training", "web")


def _turn(item: pytest.Item) -> int:
    """Place of a test's file: 0 is first."""
    file = item.path.relative_to(Path(__file__).parent)
    if file.as_posix() in COMPILE:
        return 0
    return 1 if file.parts[0] in NEED_NO_LOOP else 2


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(
    config: pytest.Config, items: list[pytest.Item]
) -> None:
    if (seed := config.getoption("--shuffle")) is None:
        items.sort(key=_turn)
        return
    files: dict[Path, list[pytest.Item]] = defaultdict(list)
    for item in items:
        files[item.path].append(item)
    draw = random.Random(seed)
    shuffled = draw.sample(sorted(files), len(files))
    items[:] = [
        item for file in shuffled for item in draw.sample(files[file], len(files[file]))
    ]


def pytest_collection_finish() -> None:
    gc.freeze()
    gc.enable()


SHARED = re.compile(
    r"tests/(architecture)/|tests/(study)/test_(?:agreement|disputes|episodes|figures|"
    r"findings|network_table|overview|partial_report|report|trigger_table)\.py"
)
"""Files that share what is made once: syntax trees, and a study that is drawn."""


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: Any) -> Any:
    """Give files that share something dear to the same worker.

    Any: of xdist, which need not be installed.
    """
    from xdist.scheduler import LoadFileScheduling

    class BySharing(LoadFileScheduling):
        def _split_scope(self, nodeid: str) -> str:
            file = super()._split_scope(nodeid)
            return room[room.lastindex] if (room := SHARED.match(file)) else file

    return BySharing(config, log) if config.getoption("dist") == "loadfile" else None


def compile_once() -> None:
    """Let processes that need one entry wait for the first, and read what it made."""
    compile_anew = Dispatcher.compile

    def compile_or_wait(self: Dispatcher, signature: object) -> object:
        if isinstance(self._cache, NullCache):
            return compile_anew(self, signature)
        name = f"{self.py_func.__module__}.{self.py_func.__qualname__}.lock"
        # Threads of this process wait at Numba's own lock, so that none can hold one
        # lock and wait for the other.
        with global_compiler_lock, FileLock(cache_folder() / name):
            return compile_anew(self, signature)

    Dispatcher.compile = compile_or_wait


compile_once()


@pytest.fixture
def few_resamplings(monkeypatch: pytest.MonkeyPatch) -> None:
    """Intervals from fifty resamplings, for tests of what else stands beside them."""
    from costeer.training import bootstrap

    whole = bootstrap.resamplings
    monkeypatch.setattr(
        bootstrap,
        "resamplings",
        lambda drivers, number, seed: whole(drivers, min(number, 50), seed),
    )


@pytest.fixture
def undrawn(monkeypatch: pytest.MonkeyPatch) -> None:
    """Figures of which only an empty file is written, for tests of what is beside."""
    from costeer.pages import frame

    monkeypatch.setattr(frame, "svg_text", lambda *_: '<svg viewBox="0 0 1 1"></svg>')


@pytest.fixture(scope="session")
def compiled_drive() -> None:
    """Machine code of a drive on the disk, for the processes that a test starts."""
    from costeer.intention.predictors.chosen import chosen_predictor
    from costeer.plant.parameters import CarParameters, RoadParameters
    from costeer.runtime.verdicts import Reader
    from tests.runtime.rig import Rig, drive_setup, wheel_setup

    for setup in (drive_setup(), wheel_setup()):
        Rig(setup).close()
    Reader(CarParameters(), RoadParameters(), (), chosen_predictor()).warm_up()
