"""Machine code is found again, and an edit anywhere in what it is made of is seen."""

from __future__ import annotations

import contextlib
import os
import shutil
import subprocess
import sys
import threading
from pathlib import Path
from typing import Any

import pytest

from costeer.base import entry, notice
from costeer.base.entry import COMPILED_ROOMS, cache_folder, source_hash


def torque_of(angle: float) -> float:
    return 3.0 * angle


EQUATION = """
from numba.extending import register_jitable

@register_jitable
def torque(angle):
    return {factor} * angle
"""

LOOP = """
from costeer.base.entry import entry
from costeer.plant.equation import torque

@entry
def run(angle):
    return torque(angle)

if __name__ == "__main__":
    import costeer.loop.main as imported  # numba caches importable modules only
    print(imported.run(10.0), sum(imported.run.stats.cache_hits.values()))
"""


def write_package(folder: Path, factor: float) -> None:
    """A package of two rooms whose loop calls an equation of the plant."""
    package = folder / "costeer"
    base = Path(entry.__file__).parent
    no_cache = shutil.ignore_patterns("__pycache__")
    shutil.copytree(base, package / "base", ignore=no_cache, dirs_exist_ok=True)
    for room in ("plant", "loop"):
        (package / room).mkdir(parents=True, exist_ok=True)
        (package / room / "__init__.py").touch()
    (package / "__init__.py").touch()
    (package / "plant" / "equation.py").write_text(EQUATION.format(factor=factor))
    (package / "loop" / "main.py").write_text(LOOP)


def run_package(folder: Path) -> tuple[float, int]:
    """What the loop gives in a new process, and how much it took from the cache."""
    environment = os.environ | {
        "PYTHONPATH": str(folder),
        "COSTEER_CACHE": str(folder / "cache"),
    }
    command = [sys.executable, "-m", "costeer.loop.main"]
    done = subprocess.run(
        command, cwd=folder, env=environment, capture_output=True, text=True, check=True
    )
    result, hits = done.stdout.split()
    return float(result), int(hits)


@pytest.mark.slow
def test_editing_a_called_equation_changes_the_result(tmp_path: Path) -> None:
    write_package(tmp_path, factor=2.0)
    assert run_package(tmp_path) == (20.0, 0)
    assert run_package(tmp_path) == (20.0, 1)  # now from the cache
    write_package(tmp_path, factor=3.0)
    assert run_package(tmp_path) == (30.0, 0)


@pytest.mark.parametrize("room", COMPILED_ROOMS)
def test_the_hash_sees_every_compiled_room(tmp_path: Path, room: str) -> None:
    file = tmp_path / room / "deep" / "equation.py"
    file.parent.mkdir(parents=True)
    hashes = {source_hash(tmp_path)}
    for text in ("x = 1\n", "x = 2\n"):
        file.write_text(text)
        hashes.add(source_hash(tmp_path))
    file.rename(file.with_name("renamed.py"))
    assert len(hashes | {source_hash(tmp_path)}) == 4


def test_the_hash_ignores_rooms_that_are_not_compiled(tmp_path: Path) -> None:
    before = source_hash(tmp_path)
    (tmp_path / "study").mkdir()
    (tmp_path / "study" / "tables.py").write_text("x = 1\n")
    assert source_hash(tmp_path) == before


def test_the_cache_keeps_the_newest_few_sources(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COSTEER_CACHE", str(tmp_path))
    for age in range(6):
        folder = tmp_path / "numba" / f"earlier-{age}"
        folder.mkdir(parents=True)
        os.utime(folder, (1e9 - age, 1e9 - age))
    current = cache_folder.__wrapped__()
    kept = {folder.name for folder in (tmp_path / "numba").iterdir()}
    assert kept == {current.name, "earlier-0", "earlier-1"}


@pytest.fixture
def told(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """What a user is told of machine code."""
    lines: list[str] = []
    monkeypatch.setattr(notice, "tellers", [lines.append])
    return lines


def test_without_a_writable_cache_a_folder_of_this_process_alone_serves(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, told: list[str]
) -> None:
    (tmp_path / "file").touch()
    monkeypatch.setenv("COSTEER_CACHE", str(tmp_path / "file"))
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    one, other = cache_folder.__wrapped__(), cache_folder.__wrapped__()
    assert one != other  # nobody could know the name and lay code there before
    assert one.parent == tmp_path
    assert one.stat().st_mode & 0o777 == 0o700
    assert "Not a directory; set COSTEER_CACHE to a folder of yours" in told[0]


def test_a_folder_that_others_may_write_to_is_not_trusted(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, told: list[str]
) -> None:
    monkeypatch.setenv("COSTEER_CACHE", str(tmp_path / "shared"))
    usual = cache_folder.__wrapped__()
    assert usual.is_relative_to(tmp_path / "shared")
    assert usual.stat().st_mode & 0o777 == 0o700
    usual.parent.chmod(0o777)
    assert not cache_folder.__wrapped__().is_relative_to(tmp_path / "shared")
    assert "everybody may write there" in told[0]
    usual.parent.chmod(0o700)
    monkeypatch.setattr(os, "getuid", lambda: usual.stat().st_uid + 1)
    assert not cache_folder.__wrapped__().is_relative_to(tmp_path / "shared")
    assert "it belongs to somebody else" in told[1]


def damages(content: bytes) -> list[bytes]:
    """What a full disk, a broken one or a thief makes of a file."""
    flipped = bytes([*content[:40], content[40] ^ 1, *content[41:]])
    return [b"", content[:10], content[:-1], content[: len(content) // 2], flipped]


def test_machine_code_that_is_damaged_is_made_anew_and_that_is_told(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, told: list[str]
) -> None:
    monkeypatch.setattr(entry, "cache_folder", lambda: tmp_path)

    def compiled() -> Any:
        return entry.entry(torque_of)

    assert compiled()(2.0) == 6.0
    kept = {path: path.read_bytes() for path in tmp_path.rglob("*.nb?")}
    assert {path.suffix for path in kept} == {".nbi", ".nbc"}
    again = compiled()
    assert (again(2.0), sum(again.stats.cache_hits.values())) == (6.0, 1)
    for path, content in kept.items():
        for damaged in damages(content):
            path.write_bytes(damaged)
            told.clear()
            once_more = compiled()
            assert once_more(2.0) == 6.0
            assert sum(once_more.stats.cache_hits.values()) == 0
            assert "was damaged; it is made anew" in told[0]
            assert compiled()(2.0) == 6.0


RIVAL = """
from typing import NamedTuple
from numba.extending import register_jitable

class State(NamedTuple):
    value: float

@register_jitable
def step(state):
    return State(2.0 * state.value)

LIKE = State(0.0)
"""

TWICE = """
import sys
import threading
from costeer.base.entry import entry_for
from costeer.base.packing import packed, pack, unpack
from costeer.base.plugins import load_object

def compiled(place):
    step = load_object(place + ":step", object, "")
    like = load_object(place + ":LIKE", object, "")

    def run(state):
        pack(state, step(unpack(like, state)))

    return entry_for((step,), run)

def ran(place):
    run, state = compiled(place), packed((10.0,))
    run(state)
    return f"{state[0]} {sum(run.stats.cache_hits.values())}"

if __name__ == "__main__":
    from twice import ran
    print(",".join(ran(place) for place in sys.argv[1:]))
"""


@pytest.mark.slow
@pytest.mark.parametrize("order", [1, -1])
def test_one_file_under_two_names_has_machine_code_for_each(
    tmp_path: Path, order: int
) -> None:
    rival = tmp_path / "damped.py"
    rival.write_text(RIVAL)
    (tmp_path / "twice.py").write_text(TWICE)
    path = os.pathsep.join([str(tmp_path), *sys.path])
    environment = os.environ | {
        "PYTHONPATH": path,
        "COSTEER_CACHE": str(tmp_path / "cache"),
    }

    def ran(*places: str) -> str:
        command = [sys.executable, str(tmp_path / "twice.py"), *places]
        done = subprocess.run(
            command, env=environment, capture_output=True, text=True, check=True
        )
        return done.stdout.strip()

    places = [str(rival), "damped"][::order]
    assert [ran(place) for place in places] == ["20.0 0", "20.0 0"]
    assert [ran(place) for place in places] == ["20.0 1", "20.0 1"]
    assert ran(*places) == ran(*places[::-1]) == "20.0 1,20.0 1"


def test_threads_do_not_take_each_other_s_folders(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    # With the folders mixed up, machine code lay in the directory of the caller.
    together = threading.Barrier(2)
    seen: list[tuple[str, str]] = []

    def kept(dispatcher: Any, _: object) -> Any:
        before = entry._settings.CACHE_DIR
        with contextlib.suppress(threading.BrokenBarrierError):
            together.wait(0.2)  # one at a time: the other one cannot come
        seen.append((before, entry._settings.CACHE_DIR))
        return dispatcher

    monkeypatch.setattr(entry, "_kept", kept)
    usual = entry._settings.CACHE_DIR
    threads = [
        threading.Thread(target=entry.entry_for, args=((torque_of,), lambda x: x))
        for _ in range(2)
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(seen) == 2
    assert all(str(cache_folder()) in folder for pair in seen for folder in pair)
    assert usual == entry._settings.CACHE_DIR
