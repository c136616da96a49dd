"""The server that runs an application until someone stops it."""

from __future__ import annotations

import errno
import logging
import os
import socket
import sys
import threading
import webbrowser
from collections.abc import Callable
from typing import NamedTuple

import uvicorn
from starlette.types import ASGIApp

from costeer.web.security import Access

LARGEST_FRAME = 4096
"""What is read of a socket's message at most [bytes]; larger ones end the socket."""

SHUTDOWN = 2
"""Time that open sockets get to close when the server ends [s]."""


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


def serve(
    make_app: Callable[[Access], ASGIApp],
    access: Access,
    announce: Callable[[Running], None],
) -> None:
    """Listen, say so, and answer until the server is stopped.

    Args:
        make_app: Makes the application, once the port is known.
        access: Where to listen and who may ask; port 0 takes any free one.
        announce: Is called when pages may be opened.

    Raises:
        ValueError: If it cannot listen there.
        KeyboardInterrupt: If it was stopped from the keyboard, after it has closed.
    """
    with listening(access.host, access.port) as listener:
        taken = access._replace(port=listener.getsockname()[1])
        server = uvicorn.Server(_settings(make_app(taken)))

        def stop() -> None:
            server.should_exit = True

        told = Running(
            access=taken,
            address=page_address(taken),
            experimenter_address=page_address(taken, experimenter=True),
            stop=stop,
        )
        announce(told)
        server.run(sockets=[listener])


def _settings(app: ASGIApp) -> uvicorn.Config:
    """How uvicorn runs here; components were measured with just these settings."""
    return uvicorn.Config(
        app,
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
