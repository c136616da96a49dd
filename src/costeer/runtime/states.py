"""Where a trial stands, what may be wrong, what the car touches: a table each.

The number of a member stands in a frame; its name in records and messages. The page is
sent the tables in its hello and has no list of its own.
"""

from __future__ import annotations

from enum import IntEnum, unique
from typing import Self


class _Named(IntEnum):
    """A member has a number for frames and a name for everyone else."""

    @property
    def word(self) -> str:
        """Its name in records and messages: `wheel_lost`."""
        return self.name.lower()


@unique
class RunState(_Named):
    """Where a trial stands; a drive begins with the first.

    Attributes:
        title: What the page says in large letters; nothing while a person drives.
        lines: What it says below, keys in brackets.
        goes_on_by: Command by which the driver's key goes on from here; "" if none.
    """

    title: str
    lines: tuple[str, ...]
    goes_on_by: str

    def __new__(
        cls, number: int, title: str, lines: tuple[str, ...], goes_on_by: str
    ) -> Self:
        """A member with what the page says of it."""
        state = int.__new__(cls, number)
        state._value_ = number
        state.title, state.lines, state.goes_on_by = title, lines, goes_on_by
        return state

    WAITING = (
        0,
        "Ready",
        ("Press [Enter] or [Space] to start.", "[H] shows the keys."),
        "start",
    )
    RUNNING = 1, "", (), ""
    PAUSED = 2, "Paused", ("Press [Enter] or [Space] to go on.",), "resume"
    ENDED = 3, "The drive is over", ("Thank you.",), ""


@unique
class Fault(_Named):
    """What is wrong; each pauses a running trial at once and takes the torque off.

    Torque never comes back by the key with which drives begin alone: somebody has to
    say first that the fault was seen and mended (`ACKNOWLEDGED`).

    Attributes:
        text: For people: what it is, and the way out.
        can_resume: Whether the same trial can go on; else it must be begun anew.
    """

    text: str
    can_resume: bool

    def __new__(cls, number: int, text: str, can_resume: bool = True) -> Self:
        """A member with its words and whether the trial can go on."""
        fault = int.__new__(cls, number)
        fault._value_ = number
        fault.text, fault.can_resume = text, can_resume
        return fault

    @property
    def must_be_acknowledged(self) -> bool:
        """Whether nobody goes on before someone has said that it is mended.

        A page that was closed or hidden needs nothing: nothing is broken, and who
        presses the key sits before it again.
        """
        free = ("NONE", "PAGE_LOST", "ACKNOWLEDGED")
        return self.can_resume and self.name not in free

    NONE = 0, ""
    WHEEL_LOST = 1, "The steering wheel was lost. Plug it in again."
    PAGE_LOST = 2, "The page did not answer for a moment."
    SENSOR_STALE = 3, "The steering wheel says nothing new. Check its cable."
    NOT_FINITE = (
        4,
        "A number was not finite. The experimenter must restart the trial.",
        False,
    )
    STALLED = (
        5,
        "The computer was too busy for a moment; costeer doctor says how to mend it.",
    )
    WATCHDOG_STILL = (
        7,
        "The watchdog stood still, so that nobody watched the steering wheel.",
    )
    RECORD_STOPPED = (
        8,
        "The record cannot be written, so the trial waits. Make room on the disk; "
        "costeer goes on trying.",
        False,
    )
    UNWATCHED = (
        10,
        "The watchdog has ended, so that nobody watches the steering wheel. Start "
        "costeer drive again.",
        False,
    )
    RECORD_MENDED = 9, "The record can be written again."
    ACKNOWLEDGED = 11, "What was wrong is mended."
    LOOP_GONE = (
        6,
        "The real-time process has ended. Start costeer drive again.",
        False,
    )


@unique
class Loss(_Named):
    """What a drive has lost and goes on without; both pages say so as long as it lasts.

    Attributes:
        text: For people: what it is, and the way out.
    """

    text: str

    def __new__(cls, number: int, text: str) -> Self:
        """A member with its words."""
        loss = int.__new__(cls, number)
        loss._value_ = number
        loss.text = text
        return loss

    WATCHDOG = 1, Fault.UNWATCHED.text
    NETWORK = (
        2,
        "The intention network has ended: no lane change is read any more. Start "
        "costeer drive again.",
    )
    HEAD = (
        3,
        "The head tracker has ended: the head is not seen any more. Start costeer "
        "drive again.",
    )
    CAMERA = (
        4,
        "The head tracker finds no camera or source: the head is not seen. Plug it in, "
        "or look at costeer head calibrate.",
    )


@unique
class Contact(_Named):
    """What the car touches, as the column `contact` counts it (plant/place.py).

    Attributes:
        text: For people.
    """

    text: str

    def __new__(cls, number: int, text: str) -> Self:
        """A member with its words."""
        contact = int.__new__(cls, number)
        contact._value_ = number
        contact.text = text
        return contact

    NOTHING = 0, ""
    RUMBLE_STRIP = 1, "The wheels run on the rumble strip."
    BARRIER = 2, "The car has hit the barrier."
    CAR = 3, "The car has hit another car or an obstacle."


def page_tables() -> dict[str, object]:
    """The tables as pages are sent them."""
    return {
        "run_states": [
            {
                "code": int(each),
                "name": each.word,
                "title": each.title,
                "lines": list(each.lines),
                "goes_on_by": each.goes_on_by,
            }
            for each in RunState
        ],
        "faults": [
            {
                "code": int(each),
                "name": each.word,
                "text": each.text,
                "can_resume": each.can_resume,
                "must_be_acknowledged": each.must_be_acknowledged,
            }
            for each in Fault
        ],
        "contacts": [
            {"code": int(each), "name": each.word, "text": each.text}
            for each in Contact
        ],
    }
