"""On what it was measured: processor, cores, load, versions."""

from __future__ import annotations

import os
import platform
import re
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from costeer.scale.jobs import default_jobs

_PACKAGES = ("costeer", "numpy", "numba", "jax")
_LINUX_PROCESSOR = Path("/proc/cpuinfo")


def machine() -> dict[str, str | int]:
    """What a reader must know to compare numbers."""
    return {
        "processor": processor_name(),
        "cores": default_jobs(),
        "load": load(),
        "system": platform.platform(),
        "python": platform.python_version(),
        **{name: found for name in _PACKAGES if (found := _version(name))},
    }


def processor_name() -> str:
    """Name of the processor as the system tells it."""
    if _LINUX_PROCESSOR.exists():
        text = _LINUX_PROCESSOR.read_text(encoding="utf-8")
        if named := re.search(r"^model name\s*:\s*(.+)$", text, re.MULTILINE):
            return named[1]
    return platform.processor() or platform.machine()


def load() -> str:
    """Processes that wanted to run in the last minute, if the system tells."""
    if not hasattr(os, "getloadavg"):
        return "not known"
    return f"{os.getloadavg()[0]:.1f}"


def _version(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:
        return ""
