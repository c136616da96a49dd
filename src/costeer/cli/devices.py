"""Which wheel and which head tracker a drive takes, from the words of its options."""

from __future__ import annotations

import re
import zlib
from typing import TYPE_CHECKING, NamedTuple

from costeer.cli.console import note

if TYPE_CHECKING:
    from costeer.devices.head.calibration import HeadCalibration
    from costeer.devices.head.source import HeadDescription
    from costeer.devices.wheels.calibration import WheelCalibration
    from costeer.devices.wheels.interface import WheelDescription

_OPENTRACK_PORT = "4242"
_LARGEST_NUMBER = 10_000_000


class ChosenWheel(NamedTuple):
    """What steers.

    Attributes:
        input: "keyboard", "gamepad" or "wheel".
        description: Of a wheel; None for virtual hands.
        calibration: Of a wheel; None for virtual hands.
    """

    input: str
    description: WheelDescription | None = None
    calibration: WheelCalibration | None = None


def chosen_wheel(word: str) -> ChosenWheel:
    """The wheel that an option names.

    Args:
        word: auto, keyboard, gamepad, simulated[:HANDS], a number of `costeer wheel
            list`, or can:BUS:CHANNEL.

    Raises:
        ValueError: If there is no such wheel, or it is not calibrated.
        ModuleNotFoundError: If the package for it is not installed.
    """
    if word in ("keyboard", "gamepad"):
        return ChosenWheel(input=word)
    if word == "auto":
        return _calibrated_wheel()
    if word == "simulated" or word.startswith("simulated:"):
        return _simulated_wheel(word.partition(":")[2])
    return _with_calibration(_named_wheel(word))


def _with_calibration(description: WheelDescription) -> ChosenWheel:
    from costeer.devices.wheels.store import load_calibration

    return ChosenWheel("wheel", description, load_calibration(description))


def _simulated_wheel(hands: str) -> ChosenWheel:
    """A simulated wheel.

    Args:
        hands: Who holds it: empty for hands that keep it straight, `keys`,
            `virtual[:SEED]`, or a script FILE.csv.

    Raises:
        ValueError: If there are no such hands.
        OSError: If the script cannot be read.
    """
    from pathlib import Path

    from costeer.devices.wheels.hands import read_script
    from costeer.devices.wheels.simulated import (
        SimulatedWheelParameters,
        SpringHands,
        simulated_description,
        true_calibration,
    )

    kind, _, seed = hands.partition(":")
    if not hands:
        held: SpringHands | dict[str, object] = SpringHands()
    elif kind == "keys":
        held = {"kind": "keys"}
    elif kind == "virtual" and (seed or "1").isdigit():
        held = {"kind": "virtual", "seed": int(seed or 1)}
    elif hands.endswith(".csv"):
        held = {"kind": "script", "script": read_script(Path(hands))}
    else:
        raise ValueError(
            f"hands '{hands}' of a simulated wheel are not known; give simulated, "
            "simulated:keys, simulated:virtual[:SEED] or simulated:FILE.csv"
        )
    return ChosenWheel(
        "wheel",
        simulated_description(hands=held),
        true_calibration(SimulatedWheelParameters()),
    )


def _named_wheel(word: str) -> WheelDescription:
    from costeer.devices.wheels.registry import found_wheels

    if channel := word.removeprefix("can:") if word.startswith("can:") else "":
        return found_wheels(can=channel)[0]
    if not word.isdigit():
        raise ValueError(
            f"--wheel is {word!r}; give auto, keyboard, gamepad, simulated[:HANDS], a "
            "number of `costeer wheel list`, or can:BUS:CHANNEL"
        )
    found = found_wheels()
    number = int(word)
    if not 1 <= number <= len(found):
        raise ValueError(
            f"--wheel is {number}, but {len(found)} wheels are plugged in; see: "
            "costeer wheel list"
        )
    return found[number - 1]


def _calibrated_wheel() -> ChosenWheel:
    """The first wheel that is plugged in and calibrated, else the keyboard."""
    from costeer.devices.wheels.registry import found_wheels

    try:
        found = found_wheels()
    except (ModuleNotFoundError, OSError) as error:
        note(f"costeer: no steering wheel: {error}; the keyboard steers")
        return ChosenWheel("keyboard")
    for description in found:
        try:
            return _with_calibration(description)
        except ValueError as error:
            note(f"costeer: {error}")
    note("costeer: no calibrated steering wheel is plugged in; the keyboard steers")
    return ChosenWheel("keyboard")


def chosen_head(word: str, participant: str) -> HeadCalibration | None:
    """The head tracker that an option names, with the participant's calibration.

    Args:
        word: none, calibrated, webcam[:N or FILE], lsl:NAME or opentrack[:PORT].
        participant: Pseudonym.

    Raises:
        ValueError: If there is no such tracker, or the participant is not calibrated.
    """
    from costeer.devices.head.calibration import HeadCalibration, load_calibration

    if word == "none":
        return None
    if word == "calibrated":
        return load_calibration(participant)
    tracker = _tracker(word)
    try:
        stored = load_calibration(participant)
    except ValueError as error:
        note(f"costeer: {error}; until then the tracker's own angle is taken")
        return HeadCalibration("", tracker)
    if stored.tracker[:2] != tracker[:2]:  # kind and address; the rest was calibrated
        note(
            f"costeer: participant {participant} was calibrated with another head "
            f"tracker; run: costeer head calibrate --participant {participant}"
        )
        return HeadCalibration("", tracker)
    return stored


def _tracker(word: str) -> HeadDescription:
    from costeer.devices.head.source import HeadDescription

    kind, _, address = word.partition(":")
    usual = {"webcam": "0", "opentrack": _OPENTRACK_PORT, "lsl": ""}
    if kind not in usual or not (address or usual[kind]):
        raise ValueError(
            f"--head is {word!r}; give none, calibrated, webcam[:N or FILE], lsl:NAME "
            "or opentrack[:PORT]"
        )
    return HeadDescription(kind, address or usual[kind])


def pseudonym_number(participant: str) -> int:
    """A whole number for a pseudonym, the same every time: P07 is 7.

    Raises:
        ValueError: If it is empty or holds what no file name should.
    """
    if not re.fullmatch(r"[A-Za-z0-9_-]{1,32}", participant):
        raise ValueError(
            f"--participant is {participant!r}; give a pseudonym of 1 to 32 letters, "
            "digits, - or _"
        )
    digits = "".join(letter for letter in participant if letter.isdigit())
    number = int(digits) if digits else zlib.crc32(participant.encode())
    return number % _LARGEST_NUMBER
