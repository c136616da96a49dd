"""Mistakes by name: what each of them sets in the loop, and how large it may be.

A scenario lists them, `mistakes: [{kind: late-trigger, size: 0.8}]`, and so does
`--mistake late-trigger=0.8`. What they do stands in loop/mistakes.py.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from typing import NamedTuple

from costeer.base.described import nearest

TRIGGER, SENSOR, MOTOR = "trigger", "sensor", "motor"
KNOWLEDGE, CAR, DRIVER = "knowledge", "car", "driver"
"""Who makes a mistake."""


class Mistake(NamedTuple):
    """A mistake that a scenario makes.

    Attributes:
        kind: One of `MISTAKES`.
        size: In the unit of the kind; None: the usual one.
    """

    kind: str
    size: float | None = None


class MistakeKind(NamedTuple):
    """What a mistake is.

    Attributes:
        about: One sentence for people; `{}` stands for the size.
        whose: Who makes it: `TRIGGER` to `DRIVER`.
        leaf: Dotted name of the parameter that takes the size.
        unit: Of the size; empty if there is none.
        size: Usual one.
        low: Smallest.
        high: Largest.
        also: Other parameters that it sets.
    """

    about: str
    whose: str
    leaf: str
    unit: str = ""
    size: float = 1.0
    low: float = 1.0
    high: float = 1.0
    also: tuple[tuple[str, float], ...] = ()


_OFF = (("mistakes.off", 1.0),)

MISTAKES: dict[str, MistakeKind] = {
    "false-trigger": MistakeKind(
        "a trigger that nobody wants, every {}",
        TRIGGER,
        "mistakes.false_trigger_period",
        "s",
        60.0,
        5.0,
        3600.0,
        (("mistakes.false_trigger", 1.0),),
    ),
    "missed-trigger": MistakeKind(
        "no trigger of the driver's own intention arrives",
        TRIGGER,
        "mistakes.missed_trigger",
    ),
    "late-trigger": MistakeKind(
        "triggers arrive {} late",
        TRIGGER,
        "mistakes.trigger_delay",
        "s",
        1.0,
        0.05,
        5.0,
    ),
    "wrong-side": MistakeKind(
        "triggers name the other side, where there is a lane",
        TRIGGER,
        "mistakes.wrong_side",
    ),
    "given-up": MistakeKind(
        "a share of {} of the lane changes is given up, and then a trigger comes",
        TRIGGER,
        "driver.decision.abandoned_share",
        "-",
        0.5,
        0.01,
        1.0,
        (("mistakes.trigger_when_given_up", 1.0),),
    ),
    "head-lost": MistakeKind("the head is never seen", SENSOR, "mistakes.head_lost"),
    "torque-bias": MistakeKind(
        "the driver-torque sensor is off by {}",
        SENSOR,
        "mistakes.torque_bias",
        "N·m",
        0.5,
        -3.0,
        3.0,
    ),
    "torque-dead": MistakeKind(
        "the driver-torque sensor reads nothing", SENSOR, "mistakes.torque_dead"
    ),
    "beside-centre": MistakeKind(
        "the reference lies {} beside the lane's centre",
        SENSOR,
        "mistakes.lateral_offset",
        "m",
        0.4,
        -0.7,
        0.7,
    ),
    "latency": MistakeKind(
        "the motor answers {} late", MOTOR, "mistakes.latency", "s", 0.1, 1 / 60, 0.1
    ),
    "weak-motor": MistakeKind(
        "the motor is saturated at {}",
        MOTOR,
        "mistakes.motor_limit",
        "N·m",
        1.5,
        0.1,
        5.0,
    ),
    "silent-off": MistakeKind(
        "the guidance goes off {} after the start and says nothing",
        MOTOR,
        "mistakes.off_time",
        "s",
        60.0,
        1.0,
        3600.0,
        _OFF,
    ),
    "fade-off": MistakeKind(
        "the guidance fades over {}, from 60 s after the start",
        MOTOR,
        "mistakes.off_duration",
        "s",
        4.0,
        0.1,
        60.0,
        _OFF,
    ),
    "false-steer": MistakeKind(
        "every minute it swerves for no reason, with {} for 1 s",
        MOTOR,
        "mistakes.false_steer",
        "N·m",
        3.0,
        1.0,
        5.0,
    ),
    "friction": MistakeKind(
        "the column has {} times the friction that the method assumes",
        CAR,
        "mistakes.friction_ratio",
        "-",
        2.0,
        0.1,
        5.0,
    ),
    "wrong-mass": MistakeKind(
        "the method assumes {} times the car's mass",
        KNOWLEDGE,
        "mistakes.mass_ratio",
        "-",
        1.3,
        0.7,
        1.3,
    ),
    "wrong-tyres": MistakeKind(
        "the method assumes {} times the tyres' cornering stiffness",
        KNOWLEDGE,
        "mistakes.tyre_ratio",
        "-",
        0.7,
        0.7,
        1.3,
    ),
    "short-sight": MistakeKind(
        "the driver sees {} of the road ahead",
        DRIVER,
        "driver.vision.sight",
        "m",
        5.0,
        2.0,
        50.0,
    ),
}
"""All mistakes by name."""


def size_of(mistake: Mistake) -> float:
    """Size of a mistake, the usual one if it has none of its own."""
    return MISTAKES[mistake.kind].size if mistake.size is None else mistake.size


def described(mistake: Mistake) -> str:
    """What goes wrong, in words."""
    kind = MISTAKES[mistake.kind]
    unit = "" if kind.unit in ("", "-") else f" {kind.unit}"
    return kind.about.format(f"{size_of(mistake):.3g}{unit}")


def as_told(mistake: Mistake) -> dict[str, object]:
    """A mistake as a record tells it: kind, size and words."""
    return {
        "kind": mistake.kind,
        "size": size_of(mistake),
        "about": described(mistake),
    }


def wrong_in(mistakes: Sequence[Mistake]) -> Iterator[tuple[int, str]]:
    """Place and words of everything in a list of mistakes that cannot be."""
    taken: dict[str, str] = {}
    for place, (name, size) in enumerate(mistakes):
        kind = MISTAKES.get(name)
        if kind is None:
            close = nearest(name, list(MISTAKES))
            known = ", ".join(MISTAKES)
            yield place, f"there is no mistake {name!r}{close}; give one of {known}"
            continue
        if size is not None and not kind.unit:
            yield place, f"{name} has no size; leave it out"
        elif size is not None and not kind.low <= size <= kind.high:
            unit = "" if kind.unit == "-" else f" {kind.unit}"
            told = f"{name} has size {size:g}; give a number from {kind.low:.3g} to"
            yield place, f"{told} {kind.high:g}{unit}"
        for leaf in (kind.leaf, *(other for other, _ in kind.also)):
            other = taken.setdefault(leaf, name)
            if place and other != name:
                yield place, f"{name} and {other} exclude each other; leave one out"
                break
            if place and name in (each.kind for each in mistakes[:place]):
                yield place, f"{name} stands twice; give it once"
                break


def lacks_lane(mistake: Mistake, num_lanes: float) -> str:
    """Why a mistake can never happen on a road; empty if it can.

    Args:
        mistake: Known.
        num_lanes: Of the road.
    """
    if mistake.kind != "wrong-side" or num_lanes >= 3:
        return ""
    told = f"wrong-side needs three lanes or more; this road has {num_lanes:g}"
    return f"{told}: leave it out, or give the road more"


def parsed_mistakes(words: Iterable[str]) -> tuple[Mistake, ...]:
    """Mistakes from words as `late-trigger` or `late-trigger=0.8`.

    Raises:
        ValueError: If one is not known, out of range, or stands twice.
    """
    given = []
    for word in words:
        name, equals, text = word.partition("=")
        try:
            size = float(text) if equals else None
        except ValueError:
            raise ValueError(
                f"'{word}' has no number after =; give one, as late-trigger=0.8"
            ) from None
        if size is not None and not math.isfinite(size):
            raise ValueError(f"'{word}' has no finite size; give a number")
        given.append(Mistake(name.strip(), size))
    for _, text in wrong_in(given):
        raise ValueError(text)
    return tuple(given)


def values_of(mistakes: Iterable[Mistake]) -> dict[str, float]:
    """What mistakes set, by dotted name."""
    values: dict[str, float] = {}
    for mistake in mistakes:
        kind = MISTAKES[mistake.kind]
        values[kind.leaf] = size_of(mistake)
        values.update(kind.also)
    return values
