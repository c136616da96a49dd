"""`--map lab.yaml`: names, units, signs and marks of a laboratory, written once."""

from __future__ import annotations

from collections.abc import Mapping
from math import isfinite, radians
from pathlib import Path
from typing import Any, NamedTuple

_UNITS = {
    "deg": radians(1.0),
    "deg/s": radians(1.0),
    "mrad": 1e-3,
    "km/h": 1.0 / 3.6,
    "mph": 0.44704,
    "ms": 1e-3,
    "us": 1e-6,
    "cm": 0.01,
    "mm": 0.001,
    "ft": 0.3048,
    "g": 9.80665,
    "%": 0.01,
}
_FIELDS = {
    "names": dict,
    "units": dict,
    "scale": dict,
    "flip": list,
    "sequence": str,
    "separator": str,
    "decimal": str,
    "encoding": str,
}
"""What a file of names may say, and the kind of each."""


class Lab(NamedTuple):
    """What a file of names says.

    Attributes:
        renames: Name there to name here.
        scales: Name here to the factor that gives SI units, left positive.
        sequence: Column that tells stretches apart, as named there.
        separator: Between columns of a text.
        decimal: Decimal mark of a text.
        encoding: Of a text.
    """

    renames: Mapping[str, str] = {}
    scales: Mapping[str, float] = {}
    sequence: str = ""
    separator: str = ""
    decimal: str = ""
    encoding: str = ""


def read_lab(path: Path | None) -> Lab:
    """Read a file of names; none gives nothing.

    Raises:
        ValueError: If it is no such file, naming the field.
        OSError: If it cannot be read.
    """
    if path is None:
        return Lab()
    said = _fields(path)
    names = {str(old): str(new) for old, new in said.get("names", {}).items()}
    twice = next((n for n in names.values() if list(names.values()).count(n) > 1), "")
    if twice:
        raise ValueError(f"--map {path}: names: {twice} is given twice")
    scales = {n: _factor(path, n, v) for n, v in said.get("scale", {}).items()}
    for name, unit in said.get("units", {}).items():
        if str(unit) not in _UNITS:
            raise ValueError(
                f"--map {path}: units: {name}: {unit} is not known; give one of "
                f"{', '.join(_UNITS)}, or a factor under scale"
            )
        scales[name] = scales.get(name, 1.0) * _UNITS[str(unit)]
    for name in said.get("flip", []):
        scales[str(name)] = -scales.get(str(name), 1.0)
    words = {k: str(said.get(k, "")) for k in Lab._fields[2:]}
    return Lab(names, scales, **words)


def _fields(path: Path) -> dict[str, Any]:  # Any: as YAML gives it back
    import yaml

    from costeer.base.files import read_whole

    content = read_whole(path, 1_000_000)
    try:
        said = yaml.safe_load(content)
    except Exception as error:  # whatever the parser makes of what is no YAML
        raise ValueError(f"--map {path} is not YAML: {error}") from error
    if not isinstance(said, dict):
        raise ValueError(f"--map {path} has no fields; give {', '.join(_FIELDS)}")
    for name, value in said.items():
        kind = _FIELDS.get(name)
        if kind is None:
            raise ValueError(
                f"--map {path}: there is no field {name!r}; choose from "
                f"{', '.join(_FIELDS)}"
            )
        if not isinstance(value, kind):
            wanted = {dict: "NAME: VALUE lines", list: "a list", str: "a text"}[kind]
            raise ValueError(f"--map {path}: {name}: give {wanted}")
    return said


def _factor(path: Path, name: str, value: object) -> float:
    try:
        factor = float(str(value))
    except ValueError:
        factor = 0.0
    if not isfinite(factor) or factor == 0.0:
        raise ValueError(f"--map {path}: scale: {name}: {value} is no factor")
    return factor
