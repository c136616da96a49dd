"""Cars, drivers and parameters that come from files of a user.

All are YAML: names and numbers, in SI units. A car names what differs from the default
car, a driver what differs from the usual one, a parameter file any parameter by its
dotted name or nested by its parts.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, TypeAlias, TypeVar

import yaml

from costeer.base.array import Real
from costeer.base.described import described, with_values
from costeer.base.files import read_whole, write_text
from costeer.drivers.driver import DriverParameters
from costeer.drivers.interface import AnyDriver
from costeer.drivers.population import SECOND, population_of
from costeer.drivers.registry import driver_named
from costeer.drivers.replayed import replayed_hands
from costeer.plant.parameters import CARS, CarParameters
from costeer.records.record import read_record

Record = TypeVar("Record")
Driver: TypeAlias = DriverParameters | AnyDriver
"""Who holds the wheel, as an object."""

ABOUT = "about"
"""Key of a file under which anything may stand that is no parameter."""

_MOST = 1_000_000
"""Longest file that is read [bytes]."""


class _Words(yaml.BaseLoader):
    """YAML whose values are words: no date, no 1:02 that is 62; no name twice."""

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> Any:
        names = [self.construct_object(key) for key, _ in node.value]
        twice = [name for name in names if names.count(name) > 1]
        if twice:
            raise yaml.YAMLError(f"{twice[0]} stands twice; give it once")
        return super().construct_mapping(node, deep)


def read_values(path: Path) -> dict[str, Real]:
    """Numbers of a YAML file by dotted name.

    Raises:
        ValueError: If it is no YAML mapping of numbers.
        OSError: If it cannot be read.
    """
    content = _content(path)
    content.pop(ABOUT, None)
    values: dict[str, Real] = {}
    _flatten(content, "", values, path)
    return values


def _content(path: Path) -> dict[Any, Any]:  # Any: of a file
    """The mapping of a YAML file.

    Raises:
        ValueError: If it is none.
        OSError: If it cannot be read.
    """
    text = read_whole(path, _MOST)
    try:
        content = yaml.load(text.decode("utf-8"), _Words)
    except (yaml.YAMLError, UnicodeDecodeError, RecursionError) as error:
        first = str(error).partition("\n")[0]
        raise ValueError(f"{path} is not YAML: {first}") from error
    if not isinstance(content, dict):
        raise ValueError(f"{path} is no list of names and numbers, as 'mass: 1500'")
    return content


def _flatten(
    content: Mapping[Any, Any], prefix: str, values: dict[str, Real], path: Path
) -> None:
    """Numbers of nested mappings by dotted name.

    Raises:
        ValueError: If a value is no number.
    """
    for key, value in content.items():
        name = f"{prefix}{key}"
        if isinstance(value, Mapping) and name.count(".") < 8:
            _flatten(value, f"{name}.", values, path)
            continue
        if name in values:
            raise ValueError(f"{path}: {name} is set twice; set it once")
        values[name] = _number(value, f"{path}: {name}")


def _number(value: object, name: str) -> Real:
    """The number, or flag, that a word of a file stands for.

    Raises:
        ValueError: If it is none.
    """
    if value in ("true", "false"):
        return value == "true"
    try:
        return float(str(value))
    except ValueError:
        raise ValueError(f"{name} is {value!r}; give a number") from None


def read_car(path: Path) -> CarParameters:
    """A car of a file: what it does not name is as in the default car.

    Raises:
        ValueError: If a name is not known or a value is out of range.
        OSError: If it cannot be read.
    """
    return _filled(CarParameters(), path)


def read_driver(path: Path) -> DriverParameters:
    """A driver of a file, as `costeer drivers --fit FILE --out` writes it.

    What the file does not name is as in the usual driver of the population that it is
    of: a fit from before there was tolerance stays the driver that it was.

    Raises:
        ValueError: If a name is not known or a value is out of range.
        OSError: If it cannot be read.
    """
    about = _content(path).get(ABOUT)
    told = about.get("population") if isinstance(about, dict) else None
    old = str(told) == SECOND.version
    return _filled(SECOND.usual if old else DriverParameters(), path)


def driver_of(given: str | Driver) -> Driver | str:
    """Who holds the wheel: a name, or what is in a file or at a place.

    Args:
        given: A name; parameters of a virtual driver or their file, `NAME.yaml`; a
            driver model or where it is, `FILE.py` or `module:object`; a record,
            `FILE.parquet`, whose hands are replayed.

    Raises:
        ValueError: If there is no such driver.
        OSError: If the file cannot be read.
    """
    if not isinstance(given, str):
        return given
    if given.endswith((".yaml", ".yml")):
        return read_driver(Path(given))
    if given.endswith(".parquet"):
        return replayed_hands(read_record(Path(given)))
    model = driver_named(given)
    return given if population_of(model) else model


def _filled(usual: Record, path: Path) -> Record:
    values = read_values(path)
    try:
        return with_values(usual, values)
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from error


def write_driver(
    path: Path, driver: DriverParameters, about: Mapping[str, object]
) -> None:
    """Write a driver with every parameter, so that it stays what it was.

    Args:
        path: File to write or replace.
        driver: All of its parameters are written.
        about: Where it comes from.
    """
    content = {ABOUT: dict(about)} | {d.name: d.value for d in described(driver)}
    write_text(path, yaml.safe_dump(content, sort_keys=False, allow_unicode=True))


def parse_assignments(words: Sequence[str]) -> dict[str, Real]:
    """Parameters from words as `guidance.lateral_error_gain=3`.

    Raises:
        ValueError: If a word is no name with a number, or a name stands twice.
    """
    values: dict[str, Real] = {}
    for word in words:
        name, equals, text = word.partition("=")
        try:
            value = float(text)
        except ValueError:
            equals = ""
        if not (equals and name.strip()):
            raise ValueError(
                f"'{word}' sets nothing; give NAME=NUMBER, as "
                "guidance.lateral_error_gain=3"
            )
        if name.strip() in values:
            raise ValueError(f"{name.strip()} is set twice; set it once")
        values[name.strip()] = value
    return values


def car_of(text: str) -> str | CarParameters:
    """A car by its name, or of a YAML file.

    Raises:
        ValueError: If it is neither.
        OSError: If the file cannot be read.
    """
    if text in CARS:
        return text
    if text.endswith((".yaml", ".yml")):
        return read_car(Path(text))
    raise ValueError(
        f"car '{text}' is not known; choose one of {', '.join(CARS)}, or give a file "
        "NAME.yaml"
    )
