"""Calibrations of wheels on disk: a JSON file per device in the user's folder."""

from __future__ import annotations

import hashlib
import json
import math
import os
import re
from pathlib import Path
from typing import Any, NamedTuple

from costeer.base.files import replacing
from costeer.devices.home import home_folder
from costeer.devices.wheels.calibration import WheelCalibration, checked
from costeer.devices.wheels.interface import WheelDescription

FORMAT = 1
"""Of the files; one that this code cannot read has a higher number."""

CALIBRATE = "run: costeer wheel calibrate"
"""The way out of every trouble with a calibration."""

_WHOLE = ("accelerator_axis", "brake_axis")
_LARGEST_FILE = 100_000


class StoredCalibrations(NamedTuple):
    """What lies in the folder.

    Attributes:
        calibrations: Those that can be read, by identity.
        damaged: What is wrong with each of the others, in words.
    """

    calibrations: list[WheelCalibration]
    damaged: list[str]


def calibration_path(identity: str) -> Path:
    """File of a device's calibration, whether or not it exists.

    A name that not every system takes is replaced; its hash keeps two devices apart.
    """
    name = re.sub(r"[^a-z0-9_-]", "_", identity)[:48]
    if name != identity:
        name = f"{name}-{hashlib.sha256(identity.encode()).hexdigest()[:12]}"
    return home_folder() / "wheels" / f"{name}.json"


def save_calibration(calibration: WheelCalibration) -> Path:
    """Keep a device's calibration in place of an older one; return its file.

    The file is whole at every moment: it is written beside and then renamed.

    Raises:
        ValueError: If the calibration is not possible.
    """
    path = calibration_path(checked(calibration).identity)
    path.parent.mkdir(parents=True, exist_ok=True)
    text = json.dumps({"format": FORMAT, **calibration._asdict()}, indent=2)
    with replacing(path) as partial, partial.open("w", encoding="utf-8") as file:
        file.write(text + "\n")
        file.flush()
        os.fsync(file.fileno())
    return path


def load_calibration(description: WheelDescription) -> WheelCalibration:
    """The calibration that a device was given.

    Raises:
        ValueError: If there is none, or its file is damaged; says what to run.
    """
    path = calibration_path(description.identity)
    if not path.is_file():
        raise ValueError(f"the wheel {description.name} is not calibrated; {CALIBRATE}")
    calibration = _read(path)
    if calibration.identity != description.identity:
        raise ValueError(
            f"{path} is of wheel {calibration.identity}, not of {description.name} "
            f"({description.identity}); {CALIBRATE}"
        )
    return calibration


def stored_calibrations() -> StoredCalibrations:
    """All calibrations of the user's folder."""
    found: list[WheelCalibration] = []
    damaged: list[str] = []
    for path in sorted((home_folder() / "wheels").glob("*.json")):
        try:
            found.append(_read(path))
        except ValueError as error:
            damaged.append(str(error))
    return StoredCalibrations(sorted(found, key=lambda each: each.identity), damaged)


def _read(path: Path) -> WheelCalibration:
    """The calibration in a file.

    Raises:
        ValueError: If it is damaged.
    """
    try:
        if path.stat().st_size > _LARGEST_FILE:
            raise ValueError("it is too large")
        content = json.loads(path.read_text(encoding="utf-8"))
        return checked(_calibration(content))
    # RecursionError: brackets nested by the thousand.
    except (ValueError, TypeError, OverflowError, RecursionError) as error:
        reason = _reason(error).removesuffix(f"; {CALIBRATE}")
        raise ValueError(
            f"the wheel calibration {path} is damaged ({reason}); {CALIBRATE}"
        ) from error


def _reason(error: Exception) -> str:
    if isinstance(error, (json.JSONDecodeError, UnicodeDecodeError, RecursionError)):
        return "it is not JSON"
    return str(error)


def _calibration(content: Any) -> WheelCalibration:  # Any: what JSON holds
    """Build the record from what the file says."""
    if not isinstance(content, dict) or content.get("format") != FORMAT:
        raise ValueError(f"it is not of format {FORMAT}")
    names = WheelCalibration._fields
    missing = [name for name in names if name not in content]
    if missing:
        raise ValueError(f"it lacks {', '.join(missing)}")
    values: dict[str, Any] = {name: content[name] for name in names}  # Any: of JSON
    values["identity"] = str(values["identity"])
    values["torque_curve"] = _curve(values["torque_curve"])
    for name in set(names) - {"identity", "torque_curve"}:
        number = _number(name, values[name])
        values[name] = int(number) if name in _WHOLE else number
    return WheelCalibration(**values)


def _curve(pairs: Any) -> tuple[tuple[float, float], ...]:  # Any: of JSON
    if not isinstance(pairs, list) or not all(
        isinstance(pair, list) and len(pair) == 2 for pair in pairs
    ):
        raise ValueError("its torque_curve is not a list of pairs")
    return tuple(
        (_number("torque_curve", low), _number("torque_curve", high))
        for low, high in pairs
    )


def _number(name: str, value: Any) -> float:  # Any: of JSON
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise ValueError(f"its {name} is not a number")
    if not math.isfinite(value):
        raise ValueError(f"its {name} is {value}, not a finite number")
    return float(value)
