"""The guidance as an FMU: FMI 3.0 for co-simulation, by pythonfmu3."""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
import tempfile
from importlib.util import find_spec
from pathlib import Path

from costeer.base.extras import install_command
from costeer.loop.scenario import TrialSetup, loop_parameters

SCRIPT = Path(__file__).with_name("fmu_slave.py")
"""What runs inside the FMU."""


def write_fmu(
    file: Path | str, method: str = "ibhs", condition: str = "strong-normal"
) -> Path:
    """Write a method of assistance as an FMU.

    Inputs are the fields of measurement and request, outputs those of
    `export.fmu_slave.OUTPUTS`, parameters those that `costeer parameters` lists of the
    method. Whoever runs it needs a Python in which this version of costeer is
    installed; the FMU holds the method only if that is a file.

    Args:
        file: "NAME.fmu", which must not exist.
        method: Its name, "module:object" or "FILE.py".
        condition: Of Table IV: strength and duration of lane changes.

    Returns:
        The file.

    Raises:
        ValueError: If the name does not fit or the method cannot be run.
        ModuleNotFoundError: If the extra `fmu` is not installed.

    Example:
        >>> from costeer.export.fmu import write_fmu
        >>> write_fmu("out/guidance.fmu", condition="weak-gentle")  # doctest: +SKIP
        PosixPath('out/guidance.fmu')
    """
    target = Path(file)
    if target.suffix != ".fmu" or target.exists():
        raise ValueError(f"file is {file}; give a new name that ends in .fmu")
    about = {"method": method, "condition": condition}
    loop_parameters(TrialSetup(intention="off", method=method, condition=condition))
    if find_spec("pythonfmu3") is None:
        told = f"pythonfmu3 is not installed; {install_command('fmu')}"
        raise ModuleNotFoundError(told, name="pythonfmu3")
    with tempfile.TemporaryDirectory() as made:
        folder = Path(made)
        held = [folder / "controller.json"]
        if method.endswith(".py"):
            held.append(Path(method))
            about["method"] = Path(method).name
        held[0].write_text(json.dumps(about), encoding="utf-8")
        built = _built(folder, held)
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.move(built, target)
    return target


def _built(folder: Path, held: list[Path]) -> Path:
    """The FMU, built in a folder by a process of its own, which loads what is held.

    This process may have loaded the method from another place.
    """
    words = ["-m", "pythonfmu3", "build", "-f", SCRIPT, "-d", folder, *held]
    done = subprocess.run(
        [sys.executable, *map(str, words)], capture_output=True, text=True, check=False
    )
    found = list(folder.glob("*.fmu"))
    if done.returncode != 0 or not found:
        raise ValueError(f"pythonfmu3 could not build the FMU: {done.stderr.strip()}")
    return found[0]
