"""What a page may say to the server, each message parsed and checked.

A message is one JSON object with a `type` and exactly the fields of that type. Whatever
else arrives is refused with a sentence that says what was wrong.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

from costeer.records.columns import Column
from costeer.runtime.markers import Marker, as_json, told

LARGEST_MESSAGE = 1024
"""Size of a message [bytes]."""

MOST_LATENCIES = 60
"""Latencies in one message: one for each frame of a second."""

LARGEST_SEQUENCE = 2**53 - 1
"""The largest whole number that a page counts to without loss."""

LONGEST_NAME = 64
"""Letters in the name of a parameter, condition or method."""


class Input(NamedTuple):
    """What keys, gamepad or mouse ask for; also the heartbeat of the page.

    Attributes:
        sequence: Number of this input, counted by the page.
        steer: Share of the largest intended angle in [-1, 1], left positive [-].
        accelerator: Pedal position in [0, 1] [-].
        brake: Pedal position in [0, 1] [-].
    """

    sequence: int
    steer: float
    accelerator: float
    brake: float


class Ping(NamedTuple):
    """Asks for an answer at once; `t` is the page's own clock [ms], given back."""

    t: float


class Start(NamedTuple):
    """The driver is ready."""


class Pause(NamedTuple):
    """Stand still."""


class Resume(NamedTuple):
    """Go on after a pause."""


class Acknowledge(NamedTuple):
    """A fault was seen, and what was wrong is mended."""


class Indicator(NamedTuple):
    """The indicator's lever: -1 right, 0 off, +1 left."""

    side: int


class Latency(NamedTuple):
    """What the page measured from a reading of the wheel to its pixels [ms]."""

    values: tuple[float, ...]


class Set(NamedTuple):
    """Drive on with another condition, method or value of a parameter.

    Attributes:
        name: `condition`, `method`, or of a parameter.
        value: A name for the first two, else a number in the parameter's unit.
    """

    name: str
    value: float | str


class Restart(NamedTuple):
    """Begin the trial anew."""


class Stop(NamedTuple):
    """End the trial."""


Message = (
    Input
    | Ping
    | Start
    | Pause
    | Resume
    | Acknowledge
    | Indicator
    | Latency
    | Set
    | Restart
    | Stop
)

EXPERIMENTER_ONLY = (Set, Restart, Stop)
"""What only the experimenter may say."""

# Any: a value out of JSON, and what became of it once it is checked.
_Check = Callable[[str, Any], Any]


def _shown(value: object) -> str:
    """A value for a sentence, cut short."""
    text = repr(value)
    return text if len(text) <= 40 else text[:37] + "..."


def _number(name: str, value: object, low: float, high: float) -> float:
    """A finite number in [low, high]; flags are no numbers."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise ValueError(f"{name} is {_shown(value)}; give a number")
    # Compared before it is converted: a whole number may be too large for a float.
    if not low <= value <= high:
        raise ValueError(
            f"{name} is {_shown(value)}; give a number from {low:g} to {high:g}"
        )
    return float(value)


def _between(low: float, high: float) -> _Check:
    """A check for numbers in [low, high]."""
    return lambda name, value: _number(name, value, low, high)


def _whole(low: int, high: int) -> _Check:
    """A check for whole numbers in [low, high]."""

    def check(name: str, value: object) -> int:
        if isinstance(value, bool) or not isinstance(value, int):
            raise ValueError(f"{name} is {_shown(value)}; give a whole number")
        if not low <= value <= high:
            raise ValueError(
                f"{name} is {_shown(value)}; give a number from {low} to {high}"
            )
        return value

    return check


def _name(name: str, value: object) -> str:
    """A short printable name."""
    if not isinstance(value, str):
        raise ValueError(f"{name} is {_shown(value)}; give a name")
    if not 0 < len(value) <= LONGEST_NAME or not value.isprintable():
        raise ValueError(
            f"{name} is {_shown(value)}; give 1 to {LONGEST_NAME} printable letters"
        )
    return value


def _latencies(name: str, value: object) -> tuple[float, ...]:
    """A list of latencies [ms], none longer than a minute."""
    if not isinstance(value, list):
        raise ValueError(f"{name} is {_shown(value)}; give a list of numbers")
    if len(value) > MOST_LATENCIES:
        raise ValueError(f"{name} has {len(value)}; give at most {MOST_LATENCIES}")
    # Clocks of two processes are compared, so a latency may come out a bit negative.
    return tuple(_number(f"each of {name}", each, -1e3, 60e3) for each in value)


_LARGEST = 1.7976931348623157e308
_ANY = _between(-_LARGEST, _LARGEST)
_SHARE = _between(0.0, 1.0)


def _choice(name: str, value: object) -> float | str:
    """A number or a name."""
    choice: float | str = (_name if isinstance(value, str) else _ANY)(name, value)
    return choice


class _Kind(NamedTuple):
    """A type of message: what it becomes and how each field is checked."""

    build: Callable[..., Message]
    fields: dict[str, _Check]


_KINDS: dict[str, _Kind] = {
    "input": _Kind(
        Input,
        {
            "sequence": _whole(0, LARGEST_SEQUENCE),
            "steer": _between(-1.0, 1.0),
            "accelerator": _SHARE,
            "brake": _SHARE,
        },
    ),
    "ping": _Kind(Ping, {"t": _ANY}),
    "start": _Kind(Start, {}),
    "pause": _Kind(Pause, {}),
    "resume": _Kind(Resume, {}),
    "acknowledge": _Kind(Acknowledge, {}),
    "indicator": _Kind(Indicator, {"side": _whole(-1, 1)}),
    "latency": _Kind(Latency, {"values": _latencies}),
    "set": _Kind(Set, {"name": _name, "value": _choice}),
    "restart": _Kind(Restart, {}),
    "stop": _Kind(Stop, {}),
}


def parse_message(text: str | bytes) -> Message:
    """Parse and check one message of a page.

    Args:
        text: As it came off the socket; bytes, a binary message, are refused.

    Raises:
        ValueError: If it is too long, no JSON object, of an unknown type, lacks a
            field or has one too many, or a value is of the wrong kind or out of range.
    """
    if isinstance(text, bytes):
        raise ValueError("a binary message came; send JSON text")
    size = len(text.encode("utf-8", "surrogatepass"))
    if size > LARGEST_MESSAGE:
        raise ValueError(
            f"the message has {size} bytes; at most {LARGEST_MESSAGE} are read"
        )
    fields = _object(text)
    kind = _kind(fields.pop("type", None))
    _check_names(kind.fields, fields)
    return kind.build(**{k: check(k, fields[k]) for k, check in kind.fields.items()})


def _object(text: str) -> dict[str, Any]:  # Any: values out of JSON, not yet checked
    """The JSON object in a text."""
    try:
        value = json.loads(
            text, parse_constant=_no_constant, object_pairs_hook=_no_double
        )
    except RecursionError:
        raise ValueError("the message is nested too deeply") from None
    except json.JSONDecodeError as error:
        raise ValueError(f"the message is no JSON: {error}") from None
    if not isinstance(value, dict):
        raise ValueError(f"the message is {_shown(value)}; send a JSON object")
    return value


def _no_constant(word: str) -> float:
    """Refuse what JSON has not but Python would read: NaN and the infinities."""
    raise ValueError(f"{word} is no number; give a finite one")


def _no_double(pairs: list[tuple[str, Any]]) -> dict[str, Any]:  # Any: as above
    """An object whose names are all different."""
    fields = dict(pairs)
    if len(fields) < len(pairs):
        raise ValueError("a field stands twice in the message; give each once")
    return fields


def _kind(name: object) -> _Kind:
    """What is known of a type of message."""
    if not isinstance(name, str) or name not in _KINDS:
        raise ValueError(
            f"the message's type is {_shown(name)}; known are {', '.join(_KINDS)}"
        )
    return _KINDS[name]


def _check_names(
    wanted: dict[str, _Check],
    given: dict[str, Any],  # Any: as above
) -> None:
    """Refuse a message with a field missing or one too many."""
    missing = [name for name in wanted if name not in given]
    if missing:
        raise ValueError(f"the message lacks {', '.join(missing)}")
    extra = [_shown(name) for name in given if name not in wanted]
    if extra:
        raise ValueError(f"the message has an unknown field {extra[0]}; leave it out")


def marker_shown(marker: Marker) -> dict[str, object]:
    """A marker as pages are sent it: its fields, and `text` for people."""
    return {**as_json(marker), "text": told(marker)}


def told_of(columns: Sequence[Column]) -> dict[str, object]:
    """What the page is told of the numbers of a frame."""
    return {
        "columns": [column.name for column in columns],
        "stepped": [column.name for column in columns if column.stepped],
    }


def encoded(message: dict[str, object]) -> str:
    """A message or answer as JSON text; what is not finite becomes null.

    JSON has neither NaN nor infinities, and a browser's parser refuses them.
    """
    return json.dumps(_plain(message), ensure_ascii=False, allow_nan=False)


def _plain(value: object) -> object:
    """The value with null in place of numbers that JSON has not."""
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, dict):
        return {str(key): _plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    if hasattr(value, "item"):  # a scalar of numpy
        return _plain(value.item())
    return value
