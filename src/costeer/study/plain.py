"""Settings in Python's own numbers, so that the same ones give the same hash."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, TypeVar

import numpy as np

Record = TypeVar("Record")


def plain_number(name: str, value: object, unit: str = "") -> float:
    """A number of any kind as a float.

    Raises:
        ValueError: If it is no number.
    """
    if isinstance(value, int | float | np.number):
        return float(value)
    wanted = f"a number [{unit}]" if unit else "a number"
    raise ValueError(f"{name} is {value!r}; give {wanted}")


def plain_count(value: Any) -> Any:  # Any: whatever stands for a whole number
    """NumPy's whole numbers as Python's; all else as it is."""
    return int(value) if isinstance(value, np.integer) else value


def plain_text(name: str, value: object) -> str:
    """The name of a file as it is.

    Raises:
        ValueError: If it is no text.
    """
    if isinstance(value, str):
        return value
    raise ValueError(f"{name} is {value!r}; give the name of a file")


def plain_part(name: str, value: object, kind: type[Record]) -> str | Record:
    """A name or file as it is; parameters with plain numbers.

    Args:
        name: Of the setting.
        value: A text, or parameters.
        kind: Class of the parameters.

    Raises:
        ValueError: If it is neither.
    """
    if isinstance(value, str):
        return value
    if not isinstance(value, kind):
        raise ValueError(
            f"{name} is {value!r}; give a name, a file NAME.yaml, or {kind.__name__}"
        )
    made: Record = _plain_record(name, value)
    return made


def plain_values(values: Iterable[tuple[str, object]]) -> tuple[tuple[str, float], ...]:
    """Parameters by name as floats.

    Raises:
        ValueError: If a value is no number.
    """
    return tuple((str(name), plain_number(str(name), value)) for name, value in values)


def _plain_record(name: str, record: Any) -> Any:  # Any: nested parameters
    fields = {
        field: _plain_record(f"{name}.{field}", value)
        if hasattr(value, "_fields")
        else plain_number(f"{name}.{field}", value)
        for field, value in record._asdict().items()
    }
    return record._replace(**fields)
