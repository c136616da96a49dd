"""What this computer has for costeer, and how to fix what is missing.

Each check returns a `Finding`. `costeer study` needs those that are required; the
others widen what can be done, `costeer drive` above all.
"""

from __future__ import annotations

import os
import platform
import re
import shutil
import socket
import statistics
import sys
import tempfile
import time
from collections.abc import Callable
from importlib.metadata import PackageNotFoundError, requires, version
from pathlib import Path
from typing import Literal, NamedTuple

import numpy as np

from costeer.base.extras import LIBRARIES, install_command, pip_command
from costeer.devices.wheels.interface import WheelDescription
from costeer.scale.jobs import usable_cores

OLDEST_PYTHON = (3, 11)
STUDY_MEMORY = 2.0e9
"""Memory that a study may use at most [B]."""
STUDY_DISK = 1.0e9
"""Room for the records of a study and its report [B], with some to spare."""

_EXTRAS = {each.package: each for each in LIBRARIES if each.purpose}
_SIMD = ("avx512f", "avx2", "avx", "sse4.2", "neon", "sve")


class Finding(NamedTuple):
    """What one check found.

    Attributes:
        name: What was looked at.
        status: `ok`; `missing`; or `optional`, missing but not needed by a study.
        detail: What there is.
        remedy: How to fix it; empty if it is ok.
    """

    name: str
    status: Literal["ok", "missing", "optional"]
    detail: str
    remedy: str = ""


def examine(folder: Path) -> list[Finding]:
    """Look at this computer; `folder` is where results would be written."""
    checks: list[Callable[[], Finding]] = [
        check_python,
        check_cores,
        check_memory,
        lambda: check_disk(folder),
        check_packages,
        check_simd,
        check_numba,
        check_cache,
        check_figures,
        check_timer,
    ]
    checks += [
        check_shared_memory,
        check_priority,
        check_wheels,
        check_camera,
        check_port,
        check_page,
    ]
    return [check() for check in checks] + [check_extra(name) for name in _EXTRAS]


def check_python() -> Finding:
    """Python is new enough."""
    detail = f"{platform.python_version()} on {platform.platform()}"
    if sys.version_info[:2] >= OLDEST_PYTHON:
        return Finding("Python", "ok", detail)
    return Finding("Python", "missing", detail, "install Python 3.11 or later")


def check_cores() -> Finding:
    """Cores that this process may use."""
    return Finding("Cores", "ok", f"{usable_cores()} of {os.cpu_count() or 1}")


def check_memory() -> Finding:
    """Memory is enough for a study."""
    memory = total_memory()
    if memory is None:
        return Finding("Memory", "ok", "not told by this system; a study needs 2 GB")
    detail = f"{memory / 1e9:.1f} GB"
    if memory >= STUDY_MEMORY:
        return Finding("Memory", "ok", detail)
    return Finding("Memory", "missing", detail, "a study needs 2 GB; use --jobs 1")


def total_memory() -> float | None:
    """Physical memory [B], or None where the system does not tell."""
    names = getattr(os, "sysconf_names", {})
    if "SC_PAGE_SIZE" not in names or "SC_PHYS_PAGES" not in names:
        return None
    return float(os.sysconf("SC_PAGE_SIZE")) * float(os.sysconf("SC_PHYS_PAGES"))


def check_disk(folder: Path) -> Finding:
    """There is room for a study's records."""
    nearest = next(p for p in (folder, *folder.absolute().parents) if p.exists())
    free = shutil.disk_usage(nearest).free
    detail = f"{free / 1e9:.1f} GB free at {nearest.absolute()}"
    if free >= STUDY_DISK:
        return Finding("Disk", "ok", detail)
    return Finding("Disk", "missing", detail, "free 1 GB or choose another --out")


def check_shared_memory(folder: Path = Path("/dev/shm")) -> Finding:
    """There is room for what the processes of a drive share."""
    from costeer.runtime.shared import NEEDED

    if not folder.is_dir():
        return Finding("Shared memory", "ok", "this system sets no limit")
    free = shutil.disk_usage(folder).free
    detail = f"{free / 1e6:.1f} MB free at {folder}; a drive takes {NEEDED / 1e6:.1f}"
    if free >= 2 * NEEDED:
        return Finding("Shared memory", "ok", detail)
    remedy = (
        f"end programs that use {folder}, or make it larger (in Docker: --shm-size)"
    )
    return Finding("Shared memory", "optional", detail, remedy)


def check_packages() -> Finding:
    """What a plain install brings is there."""
    versions = {name: installed_version(name) for name in plain_requirements()}
    absent = [name for name, found in versions.items() if found is None]
    if absent:
        remedy = f"run: {install_command()}"
        return Finding("Packages", "missing", f"no {', '.join(absent)}", remedy)
    detail = ", ".join(f"{name} {found}" for name, found in versions.items())
    return Finding("Packages", "ok", detail)


def plain_requirements() -> list[str]:
    """Names of the packages that costeer needs without any extra."""
    needed = [line for line in requires("costeer") or () if "extra ==" not in line]
    return [re.split(r"[^A-Za-z0-9._-]", line, maxsplit=1)[0] for line in needed]


def installed_version(package: str) -> str | None:
    """Version of an installed package, or None."""
    try:
        return version(package)
    except PackageNotFoundError:
        return None


def check_simd() -> Finding:
    """Vector instructions that compiled code uses."""
    from llvmlite import binding

    features = binding.get_host_cpu_features()
    found = [name for name in _SIMD if features.get(name)]
    detail = f"{', '.join(found) or 'none known'} ({binding.get_host_cpu_name()})"
    return Finding("SIMD", "ok", detail)


def check_numba() -> Finding:
    """The default engine compiles a function and runs it."""
    import numba

    start = time.perf_counter()
    try:
        doubled = numba.njit(cache=False)(_double)(21.0)
    except Exception as error:  # any failure is the finding
        remedy = f"reinstall: {pip_command('install')} --force-reinstall numba llvmlite"
        return Finding("Numba engine", "missing", str(error), remedy)
    seconds = time.perf_counter() - start
    detail = f"compiled and ran in {seconds:.2f} s"
    return Finding("Numba engine", "ok" if doubled == 42.0 else "missing", detail)


def _double(x: float) -> float:
    return 2.0 * x


def check_cache() -> Finding:
    """Machine code can be kept from one run to the next."""
    from costeer.base.entry import cache_folder

    folder = cache_folder()
    remedy = "set COSTEER_CACHE to a folder that you may write to"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            pass
    except OSError as error:
        return Finding("Code cache", "optional", f"{folder}: {error.strerror}", remedy)
    if folder.is_relative_to(tempfile.gettempdir()):
        return Finding("Code cache", "optional", f"{folder}, lost at restart", remedy)
    return Finding("Code cache", "ok", str(folder))


def check_figures() -> Finding:
    """Matplotlib draws a figure and has the font that the figures use."""
    from matplotlib import font_manager, get_backend
    from matplotlib.figure import Figure

    try:
        font = font_manager.findfont("DejaVu Sans", fallback_to_default=False)
        with tempfile.TemporaryFile() as file:
            Figure().savefig(file, format="svg")
    except (OSError, ValueError) as error:
        remedy = f"reinstall: {pip_command('install')} --force-reinstall matplotlib"
        return Finding("Figures", "missing", str(error), remedy)
    return Finding("Figures", "ok", f"{Path(font).name}, backend {get_backend()}")


def check_timer() -> Finding:
    """How late a sleep of 1 ms ends, which matters once a person drives."""
    resolution = time.get_clock_info("perf_counter").resolution
    late = np.sort([_lateness(0.001) for _ in range(100)]) * 1e3
    detail = (
        f"resolution {resolution * 1e9:.0f} ns; a sleep of 1 ms ends "
        f"{statistics.median(late):.2f} ms late, at worst {late[-1]:.2f} ms"
    )
    return Finding("Timer", "ok", detail)


def _lateness(duration: float) -> float:
    """How much longer than asked a sleep takes [s]."""
    start = time.perf_counter()
    time.sleep(duration)
    return time.perf_counter() - start - duration


def check_priority() -> Finding:
    """Whether the wheel's loop may use real-time priority."""
    remedy = (
        "allow it: write `@audio - rtprio 80` for your group into "
        "/etc/security/limits.d/costeer.conf and log in again"
    )
    if not hasattr(os, "sched_setscheduler"):
        return Finding("Priority", "ok", "asked for when a drive starts")
    policy, old = os.sched_getscheduler(0), os.sched_getparam(0)
    try:
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(60))
    except OSError:
        detail = "SCHED_FIFO is not permitted; steps of a drive may come late"
        return Finding("Priority", "optional", detail, remedy)
    os.sched_setscheduler(0, policy, old)
    return Finding("Priority", "ok", "SCHED_FIFO is permitted")


def check_wheels() -> Finding:
    """Steering wheels that are plugged in, and whether they are calibrated."""
    from costeer.devices.wheels.registry import found_wheels
    from costeer.devices.wheels.store import load_calibration

    try:
        found = found_wheels()
    except (ModuleNotFoundError, OSError) as error:
        way_out = f"run: {install_command('drive')}"
        return Finding("Steering wheel", "optional", str(error), way_out)
    if not found:
        detail = "none is plugged in; the keyboard steers"
        return Finding("Steering wheel", "optional", detail)
    names = ", ".join(wheel.name for wheel in found)
    for wheel in found:
        try:
            load_calibration(wheel)
        except ValueError:
            remedy = "run: costeer wheel calibrate"
            detail = f"{names}; {wheel.name} is not calibrated"
            return Finding("Steering wheel", "optional", detail, remedy)
    return Finding("Steering wheel", "ok", names)


def check_camera() -> Finding:
    """A webcam for the head, where the system tells without opening it."""
    devices = sorted(Path("/dev").glob("video*")) if os.name == "posix" else []
    if devices:
        return Finding("Camera", "ok", ", ".join(map(str, devices)))
    detail = "not seen without opening it" if sys.platform != "linux" else "none"
    remedy = "plug in a webcam, or use --head lsl:NAME or opentrack; then costeer head"
    return Finding("Camera", "optional", detail, remedy)


def check_port() -> Finding:
    """The page's port is free."""
    from costeer.web.security import DEFAULT_PORT, LOOPBACK

    with socket.socket() as probe:
        try:
            probe.bind((LOOPBACK, DEFAULT_PORT))
        except OSError:
            detail = f"{DEFAULT_PORT} is taken"
            return Finding("Port", "optional", detail, "use --port 0 for any free one")
    return Finding("Port", "ok", f"{DEFAULT_PORT} is free")


def check_page() -> Finding:
    """The libraries of the page were fetched when costeer was built."""
    from costeer.web.pages import static_folder

    vendor = static_folder() / "vendor"
    if (vendor / "three.module.js").is_file():
        return Finding("Page", "ok", "its libraries are there")
    return Finding("Page", "optional", "its libraries are missing", "run: make page")


def check_extra(package: str) -> Finding:
    """A package that an extra brings is there."""
    library = _EXTRAS[package]
    found = installed_version(package)
    if found is not None:
        return Finding(package, "ok", f"{found}, for {library.purpose}")
    told = f"not installed, for {library.purpose}"
    return Finding(package, "optional", told, install_command(library.extra))


def lab_checks(
    folder: Path, wheel: WheelDescription | None, tracker: str = "none"
) -> list[tuple[str, bool, str]]:
    """What an experimenter looks at before a participant sits down.

    Args:
        folder: Of the study.
        wheel: That participants hold; None for keys or a stick.
        tracker: Of the head, as `--head` names it.

    Returns:
        Name, whether it is well, and what there is or how to mend it.
    """
    checks = [check_disk(folder), check_shared_memory(), check_timer()]
    checks.append(check_priority())
    told = [(c.name, c.status == "ok", _told(c)) for c in checks]
    if wheel is not None:
        told.append(("Steering wheel", *_self_test(wheel)))
    if tracker.startswith("webcam"):
        camera = check_camera()
        told.append((camera.name, camera.status == "ok", _told(camera)))
    return told


def _told(finding: Finding) -> str:
    return "; ".join(part for part in (finding.detail, finding.remedy) if part)


OLD = 30.0
"""A self-test older than so many days is to be done again."""


def _self_test(wheel: WheelDescription) -> tuple[bool, str]:
    """Whether a wheel's self-test is there and recent, and what to do."""
    from costeer.devices.wheels.store import calibration_path

    path = calibration_path(wheel.identity)
    if wheel.kind == "simulated":
        return True, f"{wheel.name}; it needs no self-test"
    if not path.is_file():
        return False, f"{wheel.name} is not calibrated; run: costeer wheel calibrate"
    days = (time.time() - path.stat().st_mtime) / 86400.0
    said = f"{wheel.name}, self-test {days:.0f} days ago"
    return days <= OLD, said + ("" if days <= OLD else "; run: costeer wheel test")
