"""What the server asks of a drive, and how a drive reaches the pages that look on."""

from __future__ import annotations

import asyncio
from collections import deque
from collections.abc import Mapping
from contextlib import suppress
from typing import Literal, Protocol, TypeVar

from costeer.web.messages import Message, encoded

Role = Literal["driver", "experimenter"]

_Item = TypeVar("_Item")

MOST_FRAMES = 30
"""Frames kept for a page that is slow to take them: half a second."""

MOST_TEXTS = 1000
"""Text messages kept for a page that is slow to take them."""


class Outbox:
    """What waits to be sent to one page: the newest frames, and all text messages.

    It is filled from any thread and never blocks who fills it. Where a page is slow,
    old frames fall out; text, such as markers, is kept.

    Args:
        most_frames: Frames that are kept.
    """

    def __init__(self, most_frames: int = MOST_FRAMES) -> None:
        self._frames: deque[bytes] = deque(maxlen=most_frames)
        self._texts: deque[str] = deque(maxlen=MOST_TEXTS)
        self._loop = asyncio.get_running_loop()
        self._filled = asyncio.Event()

    def put_frame(self, frame: bytes) -> None:
        """Add one frame, little-endian float64; the oldest falls out if it is full."""
        self._frames.append(frame)
        self._wake()

    def put_text(self, text: str) -> None:
        """Add one text message."""
        self._texts.append(text)
        self._wake()

    def _wake(self) -> None:
        with suppress(RuntimeError):  # the server has ended in the meantime
            self._loop.call_soon_threadsafe(self._filled.set)

    async def take(self) -> list[str | bytes]:
        """Wait until there is something; give the texts, then all frames as one."""
        await self._filled.wait()
        self._filled.clear()
        texts, frames = _emptied(self._texts), _emptied(self._frames)
        return [*texts, b"".join(frames)] if frames else [*texts]


def _emptied(waiting: deque[_Item]) -> list[_Item]:
    """What is in the queue now, oldest first; the queue is emptied."""
    return [waiting.popleft() for _ in range(len(waiting))]


class Broadcast:
    """Everything that all pages of a drive are told. Its methods take any thread."""

    def __init__(self) -> None:
        self._outboxes: tuple[Outbox, ...] = ()

    def join(self) -> Outbox:
        """The outbox of a new page; call it in the server's event loop."""
        outbox = Outbox()
        self._outboxes = (*self._outboxes, outbox)
        return outbox

    def leave(self, outbox: Outbox) -> None:
        """Forget a page's outbox."""
        self._outboxes = tuple(each for each in self._outboxes if each is not outbox)

    @property
    def num_pages(self) -> int:
        """Pages that look on."""
        return len(self._outboxes)

    def send_frame(self, frame: bytes) -> None:
        """Send one frame, a row of little-endian float64, to every page."""
        for outbox in self._outboxes:
            outbox.put_frame(frame)

    def send(self, message: Mapping[str, object]) -> None:
        """Send one text message, a marker for example, to every page."""
        text = encoded(dict(message))
        for outbox in self._outboxes:
            outbox.put_text(text)


class DriveSession(Protocol):
    """A drive as the server sees it.

    All methods are called in the server's event loop, so they return at once. What the
    drive has to say, it says by `broadcast`, from whichever thread it likes.
    """

    @property
    def broadcast(self) -> Broadcast:
        """Where frames and text messages for all pages go."""
        ...

    def hello(self, role: Role) -> dict[str, object]:
        """The first message to a page; `type` and `role` are added by the server."""
        ...

    def apply(self, role: Role, message: Message) -> dict[str, object] | None:
        """Do what a page asks; return an answer for this page alone, or None.

        Pings are answered by the server and do not come here; what only the
        experimenter may say comes from the experimenter only.

        Raises:
            ValueError: If it cannot be done; the page is told why.
        """
        ...

    def client_joined(self, role: Role) -> None:
        """A page has opened its socket.

        Raises:
            ValueError: If it is one too many; the page is told why and let go. Then
                `client_left` is not called for it.
        """
        ...

    def client_left(self, role: Role) -> None:
        """A page's socket has closed."""
        ...
