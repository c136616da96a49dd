"""The server that runs an application until someone stops it."""

from __future__ import annotations

import asyncio
import errno
import logging
import os
import signal
import socket
import sys
import threading
import webbrowser
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType
from typing import NamedTuple

import uvicorn
from starlette.types import ASGIApp

from costeer.web.impatient import ImpatientProtocol
from costeer.web.security import Access

LARGEST_FRAME = 4096
"""What is read of a socket's message at most [bytes]; larger ones end the socket."""

SHUTDOWN = 2
"""Time that open sockets get to close when the server ends [s]."""


FAREWELL = 0.1
"""Time for a last word to the pages before their sockets close [s]."""


class Running(NamedTuple):
    """A server that has begun to listen.

    Attributes:
        access: Where, with the port that was taken.
        address: Of the page.
        experimenter_address: Of the page for the experimenter.
        stop: Ends the server; from any thread.
    """

    access: Access
    address: str
    experimenter_address: str
    stop: Callable[[], None]


class Ending(NamedTuple):
    """Who is told that the server ends.

    Attributes:
        noted: At once, in the handler of a signal perhaps: it only sets a plain flag.
        told: Before the sockets close, in the server's event loop.
    """

    noted: Callable[[], object] = int
    told: Callable[[], object] = int


class _Server(uvicorn.Server):
    """Says that it ends while pages can still be told."""

    ending = Ending()

    def handle_exit(self, sig: int, frame: FrameType | None) -> None:
        """Note a signal."""
        self.ending.noted()
        super().handle_exit(sig, frame)

    async def shutdown(self, sockets: list[socket.socket] | None = None) -> None:
        """Tell who looks on, then close."""
        self.ending.noted()
        self.ending.told()
        await asyncio.sleep(FAREWELL)
        await super().shutdown(sockets)


@contextmanager
def _hung_up(server: _Server) -> Iterator[None]:
    """End with a closed terminal as with any other signal."""
    number = getattr(signal, "SIGHUP", None)
    if number is None or threading.current_thread() is not threading.main_thread():
        yield
        return
    before = signal.signal(number, server.handle_exit)
    try:
        yield
    finally:
        signal.signal(number, before)


def serve(
    make_app: Callable[[Access], ASGIApp],
    access: Access,
    announce: Callable[[Running], None],
    ending: Ending | None = None,
) -> None:
    """Listen, say so, and answer until the server is stopped.

    Args:
        make_app: Makes the application, once the port is known.
        access: Where to listen and who may ask; port 0 takes any free one.
        announce: Is called when pages may be opened.
        ending: Who is told that it ends.

    Raises:
        ValueError: If it cannot listen there.
        KeyboardInterrupt: If it was stopped from the keyboard, after it has closed.
    """
    with listening(access.host, access.port) as listener:
        taken = access._replace(port=listener.getsockname()[1])
        server = _Server(_settings(make_app(taken)))
        server.ending = ending or Ending()

        def stop() -> None:
            server.should_exit = True

        told = Running(
            access=taken,
            address=page_address(taken),
            experimenter_address=page_address(taken, experimenter=True),
            stop=stop,
        )
        announce(told)
        with _hung_up(server):
            server.run(sockets=[listener])


def _settings(app: ASGIApp) -> uvicorn.Config:
    """How uvicorn runs here; components were measured with just these settings."""
    return uvicorn.Config(
        app,
        http=ImpatientProtocol,
        ws="websockets-sansio",
        ws_max_size=LARGEST_FRAME,
        ws_per_message_deflate=False,
        loop="auto",
        lifespan="off",  # there is nothing to begin or end; twice Ctrl-C is no error
        access_log=False,
        log_level=logging.WARNING,
        proxy_headers=False,
        server_header=False,
        timeout_graceful_shutdown=SHUTDOWN,
    )


def listening(host: str, port: int) -> socket.socket:
    """A socket that listens.

    Raises:
        ValueError: If the port is taken or not allowed, or the host is not ours.
    """
    try:
        found = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)
    except (socket.gaierror, UnicodeError) as error:
        raise ValueError(_not_ours(host)) from error
    family, kind, protocol, _, address = sorted(found)[0]  # IPv4 before IPv6
    listener = socket.socket(family, kind, protocol)
    try:
        if os.name == "posix":  # elsewhere it would let two servers share a port
            listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        listener.bind(address)
        listener.listen(100)
    except OSError as error:
        listener.close()
        raise ValueError(_why(error, host, port)) from error
    return listener


def _not_ours(host: str) -> str:
    return (
        f"host {host} is no address of this computer; leave --host out for this "
        "computer alone, or give 0.0.0.0 for all of its addresses"
    )


def _why(error: OSError, host: str, port: int) -> str:
    """What stands in the way of listening, and the way out."""
    if error.errno == errno.EADDRINUSE:
        return (
            f"port {port} is taken by another program; choose another with --port, or "
            "--port 0 for any that is free"
        )
    if error.errno == errno.EACCES:
        return f"port {port} is not allowed; choose one above 1023 with --port"
    if error.errno == errno.EADDRNOTAVAIL:
        return _not_ours(host)
    return f"cannot listen on {host}, port {port}: {error.strerror}; choose another"


def page_address(access: Access, experimenter: bool = False) -> str:
    """The address of the page, with the token if one is asked."""
    host = access.host
    if host in ("0.0.0.0", "::", ""):
        host = access.names[0] if access.names else "localhost"
    shown = f"[{host}]" if ":" in host else host
    secrets = {
        "token": access.token,
        "experimenter": access.experimenter_token if experimenter else None,
    }
    query = "&".join(f"{name}={value}" for name, value in secrets.items() if value)
    return f"http://{shown}:{access.port}/" + (f"?{query}" if query else "")


def open_page(address: str) -> threading.Thread | None:
    """Open a page in the browser, where there is a screen to show it on.

    Without one, a browser for the terminal might start and take the keyboard.

    Returns:
        The thread that waits for the browser; None if there is no screen.
    """
    screen = any(os.environ.get(name) for name in ("DISPLAY", "WAYLAND_DISPLAY"))
    if not screen and sys.platform not in ("darwin", "win32"):
        return None
    opening = threading.Thread(target=webbrowser.open, args=[address], daemon=True)
    opening.start()
    return opening
