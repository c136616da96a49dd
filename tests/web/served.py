"""A server in a thread, a drive made up for it, and short requests to it."""

from __future__ import annotations

import http.client
import logging
import socket
import threading
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path
from typing import Any, NamedTuple

from starlette.types import ASGIApp
from websockets.sync.client import ClientConnection, connect

from costeer.web.messages import Message
from costeer.web.security import Access, access_for
from costeer.web.serving import Ending, Running, serve
from costeer.web.session import Broadcast, Role
from tests.waiting import PATIENCE


class FakeSession:
    """A drive that remembers what it was asked."""

    def __init__(self) -> None:
        self.broadcast = Broadcast()
        self.applied: list[tuple[Role, Message]] = []
        self.joined: list[Role] = []
        self.left: list[Role] = []
        self.full = False

    def hello(self, role: Role) -> dict[str, object]:
        """A hello with a number that JSON has not."""
        return {"mode": "drive", "columns": ["time"], "low": float("-inf")}

    def apply(self, role: Role, message: Message) -> dict[str, object] | None:
        """Remember the message; only a gain called `unknown` is refused."""
        self.applied.append((role, message))
        if getattr(message, "name", "") == "unknown":
            raise ValueError("gain 'unknown' is not known; choose another")
        return {"type": "state", "number": len(self.applied)}

    def client_joined(self, role: Role) -> None:
        """Refuse if full."""
        if self.full:
            raise ValueError("somebody drives already; close the other page")
        self.joined.append(role)

    def client_left(self, role: Role) -> None:
        """Remember who left."""
        self.left.append(role)


class Told(logging.Handler):
    """Keeps what the server, asyncio and threads say of what went wrong."""

    LOGGERS = ("", "uvicorn")  # what uvicorn says does not reach the first

    def __init__(self) -> None:
        super().__init__()
        self.tracebacks: list[str] = []

    def emit(self, record: logging.LogRecord) -> None:
        """Keep a record that bears an exception."""
        if record.exc_info:
            self.tracebacks.append(self.format(record))

    def __enter__(self) -> Told:
        for name in self.LOGGERS:
            logging.getLogger(name).addHandler(self)
        return self

    def __exit__(self, *_: object) -> None:
        for name in self.LOGGERS:
            logging.getLogger(name).removeHandler(self)


class Answer(NamedTuple):
    """What a server said."""

    status: int
    headers: http.client.HTTPMessage
    body: bytes


def page_files(folder: Path) -> Path:
    """A page with its libraries, and a secret beside its folder."""
    static = folder / "static"
    (static / "vendor").mkdir(parents=True)
    (static / "index.html").write_text("<p>the page</p>")
    (static / "missing.html").write_text("<p>run make page</p>")
    (static / "main.js").write_text("export {};")
    (static / ".hidden").write_text("hidden")
    (folder / "secret.txt").write_text("secret")
    return static


@contextmanager
def served(
    make_app: Callable[[Access], ASGIApp],
    access: Access | None = None,
    ending: Ending | None = None,
) -> Iterator[Running]:
    """The application on a free port, until the block ends."""
    told: list[Running] = []
    ready = threading.Event()

    def announce(running: Running) -> None:
        told.append(running)
        ready.set()

    asked = access_for(port=0) if access is None else access
    thread = threading.Thread(target=serve, args=(make_app, asked, announce, ending))
    thread.start()
    try:
        assert ready.wait(PATIENCE)
        # One answer, so that the server has begun when it is told to stop.
        fetch(told[0], "/")
        yield told[0]
    finally:
        told[0].stop()
        thread.join(PATIENCE)
        assert not thread.is_alive()


def fetch(running: Running, path: str, **headers: str) -> Answer:
    """Ask for a path, exactly as it is written."""
    port = running.access.port
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=PATIENCE)
    try:
        connection.request("GET", path, headers=headers)
        answer = connection.getresponse()
        return Answer(answer.status, answer.headers, answer.read())
    finally:
        connection.close()


def raw(running: Running, text: bytes) -> socket.socket:
    """A plain connection on which something was sent."""
    made = socket.create_connection(("127.0.0.1", running.access.port), PATIENCE)
    made.sendall(text)
    return made


def own_origin(running: Running) -> str:
    """The origin that a page of the server states."""
    return f"http://127.0.0.1:{running.access.port}"


def socket_of(
    running: Running, query: str = "", **options: Any
) -> AbstractContextManager[ClientConnection]:
    """A socket as a page of the server opens it."""
    address = f"ws://127.0.0.1:{running.access.port}/ws{query}"
    chosen = {"origin": own_origin(running), "open_timeout": PATIENCE} | options
    return connect(address, compression=None, proxy=None, **chosen)
