"""Set up `.venv` from a lock: `python requirements/install.py base|dev|bench`.

Needs Python 3.11 or later with pip, nothing else. It installs a pinned uv, uses it to
install the lock, every file checked against its hash, and falls back to pip where uv
does not work. A stamp in `.venv` makes a second call do nothing.
"""

from __future__ import annotations

import hashlib
import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
ENVIRONMENT = ROOT / ".venv"
LOCKS = ("base", "dev", "bench")
CONTAINED_IN = {"base": ("base", "dev", "bench"), "dev": ("dev",), "bench": ("bench",)}
"""Locks that bring all that a lock brings, at the same versions."""

os.environ.update(
    UV_PYTHON_DOWNLOADS="never",
    PIP_DISABLE_PIP_VERSION_CHECK="1",
    PIP_REQUIRE_VIRTUALENV="0",
)


def main() -> int:
    """Set up the environment that the first argument names."""
    name = sys.argv[1] if len(sys.argv) == 2 else ""
    if name not in LOCKS:
        return complain(f"'{name}' is no lock; give one of {', '.join(LOCKS)}")
    if sys.version_info < (3, 11):  # noqa: UP036  because any Python may start this
        found = ".".join(map(str, sys.version_info[:3]))
        return complain(f"Python {found} is too old; make PYTHON=/path/to/python3.11")
    if any(is_fresh(lock) for lock in CONTAINED_IN[name]):
        return 0
    try:
        set_up(name)
    except subprocess.CalledProcessError as error:
        return complain(f"set-up failed at: {' '.join(map(str, error.cmd))}")
    return 0


def complain(message: str) -> int:
    """Print one line; return the exit code of bad input."""
    print(f"costeer set-up: {message}", file=sys.stderr)
    return 2


def set_up(name: str) -> None:
    """Install the lock and costeer itself, then leave the stamp."""
    stamp(name).unlink(missing_ok=True)
    if not works(["-c", "import sys"]):
        make_environment()
    lock = ROOT / "requirements" / f"{name}.lock"
    install(["--require-hashes", "-r", str(lock)])
    install(["--no-deps", "--no-build-isolation", "--editable", str(ROOT)])
    stamp(name).write_text(fingerprint(name), encoding="utf-8")


def make_environment() -> None:
    """Create `.venv` anew; whatever a broken set-up left there goes."""
    command = [sys.executable, "-m", "venv", "--clear"]
    has_pip = quiet([sys.executable, "-m", "pip", "--version"])
    subprocess.run(
        [*command, *(["--without-pip"] if has_pip else []), ENVIRONMENT], check=True
    )


def install(arguments: list[str]) -> None:
    """Install with uv, else with pip."""
    uv_is_there = works(["-m", "uv", "--version"]) or install_uv()
    command = [python(), "-m", "uv", "pip", "install", "--quiet"]
    if uv_is_there and run([*command, "--python", python(), *arguments]) == 0:
        return
    print("costeer set-up: uv does not work here, using pip", file=sys.stderr)
    subprocess.run([*pip(), "install", "--quiet", *arguments], check=True)


def install_uv() -> bool:
    """Install the pinned uv; tell whether it can be used."""
    lock = ROOT / "requirements" / "installer.lock"
    run([*pip(), "install", "--quiet", "--require-hashes", "-r", str(lock)])
    return works(["-m", "uv", "--version"])


def pip() -> list[str]:
    """Pip that installs into `.venv`: its own if it has one, else the caller's."""
    if works(["-m", "pip", "--version"]):
        return [python(), "-m", "pip"]
    return [sys.executable, "-m", "pip", "--python", python()]


def python() -> str:
    """Path of the interpreter in `.venv`."""
    inner = "Scripts/python.exe" if os.name == "nt" else "bin/python"
    return str(ENVIRONMENT / inner)


def works(arguments: list[str]) -> bool:
    """Whether the interpreter in `.venv` runs with these arguments."""
    return quiet([python(), *arguments])


def quiet(command: list[str]) -> bool:
    """Whether a command succeeds, without showing what it prints."""
    try:
        done = subprocess.run(command, capture_output=True, check=False)
    except OSError:
        return False
    return done.returncode == 0


def run(command: list[str]) -> int:
    """Exit code of a command that shows what it prints."""
    return subprocess.run(command, check=False).returncode


def is_fresh(name: str) -> bool:
    """Whether `.venv` works and was set up from the lock as it is now."""
    try:
        written = stamp(name).read_text(encoding="utf-8")
    except OSError:
        return False
    return written == fingerprint(name) and works(["-c", "import costeer"])


def stamp(name: str) -> Path:
    """File in `.venv` that says what was installed."""
    return ENVIRONMENT / f"{name}.stamp"


def fingerprint(name: str) -> str:
    """Hash of all that the environment depends on, the folder included."""
    folder = ROOT / "requirements"
    files = [
        folder / f"{name}.lock",
        folder / "installer.lock",
        ROOT / "pyproject.toml",
        ROOT / "hatch_build.py",
        ROOT / "page" / "package-lock.json",
    ]
    digest = hashlib.sha256(f"{ROOT} {sys.version_info[:2]}".encode())
    for file in files:
        digest.update(file.read_bytes())
    return digest.hexdigest()


if __name__ == "__main__":
    sys.exit(main())
