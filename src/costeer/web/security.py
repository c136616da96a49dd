"""Who may ask: on this computer every page of ours, from elsewhere who has the token.

A page of a foreign site that is open in the same browser is the usual attacker. It is
kept out by the names the server answers to (a foreign name may be made to lead to this
computer) and by the origin that browsers state when they open a socket.
"""

from __future__ import annotations

import asyncio
import hmac
import ipaddress
import re
import secrets
import socket
from typing import NamedTuple

from starlette.datastructures import MutableHeaders
from starlette.requests import HTTPConnection
from starlette.responses import PlainTextResponse
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from costeer.web.session import Role

LOOPBACK = "127.0.0.1"
"""The address that only this computer reaches."""

DEFAULT_PORT = 8700
"""The port if none is asked for; 0 is any free one."""

_HOST = re.compile(r"(\[[0-9a-f:.]+\]|[a-z0-9._-]+)(:[0-9]{1,5})?")


class Access(NamedTuple):
    """Where the server listens and who may ask.

    Attributes:
        host: Address or name that it listens on.
        port: Port; 0 until a free one was taken.
        token: Asked of everyone; None if only this computer can ask.
        experimenter_token: Makes an experimenter of who has it.
        names: Further names of this computer that a page may be asked under.
    """

    host: str = LOOPBACK
    port: int = DEFAULT_PORT
    token: str | None = None
    experimenter_token: str = ""
    names: tuple[str, ...] = ()


def access_for(host: str = LOOPBACK, port: int = DEFAULT_PORT) -> Access:
    """Access with new tokens; one is asked of everyone unless the host is loopback.

    Raises:
        ValueError: If the port is none.
    """
    if not 0 <= port <= 65535:
        raise ValueError(f"port is {port}; give one from 1 to 65535, or 0 for any free")
    name = socket.gethostname().lower()
    return Access(
        host=host,
        port=port,
        token=None if is_loopback(host) else secrets.token_urlsafe(16),
        experimenter_token=secrets.token_urlsafe(16),
        names=(name, f"{name}.local"),
    )


def is_loopback(host: str) -> bool:
    """Whether only this computer reaches an address or name."""
    address = _address(host)
    return host.lower() == "localhost" if address is None else address.is_loopback


def _address(host: str) -> ipaddress.IPv4Address | ipaddress.IPv6Address | None:
    """The address that a text is, None if it is a name."""
    try:
        return ipaddress.ip_address(host.strip("[]"))
    except ValueError:
        return None


def is_own_name(access: Access, host: str) -> bool:
    """Whether a `Host` header is one that this server answers to.

    On a loopback server those of loopback; else also every address, because only names
    can be made to lead elsewhere, and the names of this computer.
    """
    match = _HOST.fullmatch(host.lower())
    if match is None:
        return False
    name = match[1].removesuffix(".")
    if is_loopback(name):
        return True
    if is_loopback(access.host):
        return False
    return _address(name) is not None or name in (access.host.lower(), *access.names)


def _same(given: str | None, expected: str | None) -> bool:
    """Whether a secret is right, in a time that does not tell how much of it is."""
    if not given or not expected:
        return False
    return hmac.compare_digest(given.encode(), expected.encode())


def cookie_name(access: Access) -> str:
    """Name of the cookie; browsers share cookies between the ports of a host."""
    return f"costeer_{access.port}"


def is_experimenter(access: Access, connection: HTTPConnection) -> bool:
    """Whether a request bears the experimenter's token."""
    given = connection.query_params.get("experimenter")
    return _same(given, access.experimenter_token)


def role_of(access: Access, connection: HTTPConnection) -> Role:
    """The role of who asks."""
    return "experimenter" if is_experimenter(access, connection) else "driver"


def has_token(access: Access, connection: HTTPConnection) -> bool:
    """Whether a request bears a right token, in the address or as a cookie."""
    given = (
        connection.query_params.get("token"),
        connection.cookies.get(cookie_name(access)),
    )
    known = any(_same(each, access.token) for each in given)
    return known or is_experimenter(access, connection)


def refusal(access: Access, connection: HTTPConnection) -> str:
    """Why a request is refused, in a plain sentence; empty if it is not."""
    hosts = connection.headers.getlist("host")
    if len(hosts) != 1 or not is_own_name(access, hosts[0]):
        return (
            "This server does not answer to that name. Open the address that costeer "
            "printed."
        )
    known = has_token(access, connection)
    if access.token is not None and not known:
        return "The token is missing or wrong. Open the address that costeer printed."
    if connection.query_params.get("experimenter") and not is_experimenter(
        access, connection
    ):
        return "The experimenter's token is wrong. Open the address costeer printed."
    return _foreign(connection, hosts[0], known)


def _foreign(connection: HTTPConnection, host: str, known: bool) -> str:
    """Why the origin is refused; empty if it is not."""
    is_socket = connection.scope["type"] == "websocket"
    origins = connection.headers.getlist("origin")
    if not origins:
        if is_socket and not known:
            return "A socket is opened by a page of this server, or with a token."
        return ""
    secure = connection.url.scheme in ("https", "wss")
    own = f"{'https' if secure else 'http'}://{host}".lower()
    if [origin.lower() for origin in origins] != [own]:
        return "A page of another site asked. Only pages of this server may."
    return ""


def headers_of(host: str) -> dict[str, str]:
    """What browsers are told to forbid on our pages.

    Args:
        host: The request's own `Host`, for browsers that do not count sockets as
            belonging to 'self'.
    """
    return {
        "Content-Security-Policy": (
            "default-src 'self'; img-src 'self' data:; "
            "style-src 'self' 'unsafe-inline'; "
            f"connect-src 'self' ws://{host} wss://{host}; "
            "object-src 'none'; base-uri 'none'; form-action 'none'; "
            "frame-ancestors 'self'"
        ),
        "X-Content-Type-Options": "nosniff",
        "Referrer-Policy": "no-referrer",
        "Cross-Origin-Resource-Policy": "same-origin",
        "Cache-Control": "no-store",
    }


class Guard:
    """Stands before an application: refuses who may not ask, adds the headers.

    Args:
        app: What is asked.
        access: Who may.
    """

    def __init__(self, app: ASGIApp, access: Access) -> None:
        self._app = app
        self._access = access

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer one connection, as ASGI has it."""
        if scope["type"] == "lifespan":
            await self._app(scope, receive, send)
            return
        connection = HTTPConnection(scope)
        reason = refusal(self._access, connection)
        if reason:
            answer = PlainTextResponse(reason + "\n", 403, headers=headers_of("none"))
            await answer(scope, receive, send)
            if scope["type"] == "websocket":
                # uvicorn calls it an error to return while the socket still closes.
                await asyncio.sleep(0.05)
            return
        await self._app(scope, receive, self._with_headers(connection, send))

    def _with_headers(self, connection: HTTPConnection, send: Send) -> Send:
        """`send` that adds the headers and, for later requests, the cookie."""

        async def send_more(message: Message) -> None:
            if message["type"] == "http.response.start":
                headers = MutableHeaders(scope=message)
                headers.update(headers_of(connection.headers["host"]))
                if self._access.token is not None:
                    headers.append("Set-Cookie", self._cookie())
            await send(message)

        return send_more

    def _cookie(self) -> str:
        """The token as a cookie that no script reads and no other site sends."""
        pair = f"{cookie_name(self._access)}={self._access.token}"
        return f"{pair}; HttpOnly; SameSite=Strict; Path=/"
