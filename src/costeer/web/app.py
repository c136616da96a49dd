"""The server's two applications: a drive that goes on, and the replay of a record."""

from __future__ import annotations

import asyncio
import time
from contextlib import suppress
from pathlib import Path

from starlette.applications import Starlette
from starlette.requests import Request
from starlette.responses import Response
from starlette.routing import BaseRoute, Route, WebSocketRoute
from starlette.types import ASGIApp
from starlette.websockets import WebSocket, WebSocketDisconnect

from costeer.web import intake
from costeer.web.messages import EXPERIMENTER_ONLY, Message, Ping, encoded
from costeer.web.messages import parse_message as parsed
from costeer.web.pages import answer_file, answer_page, static_folder
from costeer.web.replay import Replay
from costeer.web.security import Access, Guard, role_of
from costeer.web.session import DriveSession, Outbox, Role

REFUSED = 1008
"""Code of a socket that is closed because of what was sent on it."""

MOST_PAGES = 16
"""Pages that may look on at once."""


def drive_app(
    session: DriveSession, access: Access, folder: Path | None = None
) -> ASGIApp:
    """The application of a drive: the page, its hello and its socket.

    Args:
        session: The drive.
        access: Who may ask.
        folder: The page's files; those of the package if None.
    """

    async def answer_hello(request: Request) -> Response:
        return json_response(hello(session, role_of(access, request)))

    async def answer_socket(websocket: WebSocket) -> None:
        await hold(websocket, session, role_of(access, websocket))

    routes: list[BaseRoute] = [
        Route("/api/hello", answer_hello),
        WebSocketRoute("/ws", answer_socket),
    ]
    return Guard(application(routes, folder), access)


def replay_app(replay: Replay, access: Access, folder: Path | None = None) -> ASGIApp:
    """The application of a replay: the page, its hello and the record.

    Args:
        replay: What is shown.
        access: Who may ask.
        folder: The page's files; those of the package if None.
    """

    async def answer_hello(request: Request) -> Response:
        told = {"type": "hello", **replay.hello, "role": role_of(access, request)}
        return json_response(told)

    async def answer_record(request: Request) -> Response:
        return Response(replay.rows, media_type="application/octet-stream")

    routes: list[BaseRoute] = [
        Route("/api/hello", answer_hello),
        Route("/api/record", answer_record),
    ]
    return Guard(application(routes, folder), access)


def application(routes: list[BaseRoute], folder: Path | None) -> Starlette:
    """Routes of the data, then the page and its files."""
    page = [Route("/", answer_page), Route("/{path:path}", answer_file)]
    app = Starlette(routes=[*routes, *page])
    app.state.folder = static_folder() if folder is None else folder
    return app


def json_response(message: dict[str, object]) -> Response:
    """An answer of JSON."""
    # Half of a pair of surrogates, which JSON may hold, is no UTF-8.
    text = encoded(message).encode("utf-8", "replace")
    return Response(text, media_type="application/json")


def hello(session: DriveSession, role: Role) -> dict[str, object]:
    """The first message to a page."""
    return {"type": "hello", **session.hello(role), "role": role}


def _error(text: object) -> dict[str, object]:
    return {"type": "error", "text": str(text)}


async def hold(websocket: WebSocket, session: DriveSession, role: Role) -> None:
    """Keep one page's socket until either side ends it."""
    await websocket.accept()
    try:
        if session.broadcast.num_pages >= MOST_PAGES:
            raise ValueError(f"{MOST_PAGES} pages are open; close one first")
        session.client_joined(role)
    except ValueError as error:
        await websocket.send_text(encoded(_error(error)))
        await websocket.close(REFUSED)
        return
    outbox = session.broadcast.join()
    try:
        await websocket.send_text(encoded(hello(session, role)))
        await _exchange(websocket, session, role, outbox)
    except WebSocketDisconnect:
        pass  # the usual end: the page was closed
    finally:
        session.broadcast.leave(outbox)
        session.client_left(role)


async def _exchange(
    websocket: WebSocket, session: DriveSession, role: Role, outbox: Outbox
) -> None:
    """Send and receive until one of the two ends; then end the other."""
    sending = asyncio.create_task(_send(websocket, outbox))
    receiving = asyncio.create_task(_receive(websocket, session, role, outbox))
    both = (sending, receiving)
    try:
        await asyncio.wait(both, return_when=asyncio.FIRST_COMPLETED)
    finally:
        for task in both:
            task.cancel()
        ends = await asyncio.gather(*both, return_exceptions=True)
    for end in ends:
        if isinstance(end, Exception):
            raise end


async def _send(websocket: WebSocket, outbox: Outbox) -> None:
    """Send what is put into the outbox, without end."""
    while True:
        for message in await outbox.take():
            if isinstance(message, str):
                await websocket.send_text(message)
            else:
                await websocket.send_bytes(message)


async def _receive(
    websocket: WebSocket, session: DriveSession, role: Role, outbox: Outbox
) -> None:
    """Read and apply messages until the page leaves or is shut out."""
    limits = intake.IntakeParameters()
    state = intake.initial_state(limits, time.perf_counter())
    while not intake.is_exhausted(limits, state):
        text = await _text(websocket)
        state, admitted = intake.admit(limits, state, time.perf_counter())
        try:
            message = _checked(text, role, admitted)
        except ValueError as error:
            state = intake.refuse(state)
            outbox.put_text(encoded(_error(error)))
            continue
        answer = _answer(session, role, message)
        if answer is not None:
            outbox.put_text(encoded(answer))
    await asyncio.sleep(0.1)  # so that the page still gets to read why
    with suppress(RuntimeError):
        await websocket.close(REFUSED, "too many messages were refused")


async def _text(websocket: WebSocket) -> str | bytes:
    """The next message.

    Raises:
        WebSocketDisconnect: If the page has left.
    """
    event = await websocket.receive()
    if event["type"] == "websocket.disconnect":
        raise WebSocketDisconnect(event.get("code", 1006))
    text: str | None = event.get("text")
    return event["bytes"] if text is None else text


def _checked(text: str | bytes, role: Role, admitted: bool) -> Message:
    """The message in a text.

    Raises:
        ValueError: If it is not admitted, malformed or not for this role to say.
    """
    if not admitted:
        raise ValueError("messages come too fast; send at most 500 a second")
    message = parsed(text)
    if isinstance(message, EXPERIMENTER_ONLY) and role != "experimenter":
        raise ValueError(
            "only the experimenter may do that; open the page's address "
            "for the experimenter"
        )
    return message


def _answer(
    session: DriveSession, role: Role, message: Message
) -> dict[str, object] | None:
    """What a page is told in return; nothing for most messages."""
    if isinstance(message, Ping):
        return {"type": "pong", "t": message.t, "server_time": time.perf_counter()}
    try:
        return session.apply(role, message)
    except ValueError as error:
        return _error(error)
