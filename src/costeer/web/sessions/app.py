"""The server of a session: two pages with different rights, and a drive."""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from starlette.concurrency import run_in_threadpool
from starlette.requests import Request
from starlette.responses import Response
from starlette.routing import BaseRoute, Route, WebSocketRoute
from starlette.types import ASGIApp
from starlette.websockets import WebSocket

from costeer.sessions.questionnaires.answers import AnswersError
from costeer.sessions.standing import OutOfStepError
from costeer.sessions.store import StoreError
from costeer.web.app import application, hello, hold, json_response
from costeer.web.pages import file_in, file_response, static_folder
from costeer.web.security import Access, Guard, is_experimenter, role_of
from costeer.web.sessions.console import Console
from costeer.web.sessions.desk import Desk

# Any, in this file: of JSON.
LARGEST_BODY = 200_000
"""Of a request [bytes]."""


def session_app(desk: Desk, access: Access, folder: Path | None = None) -> ASGIApp:
    """The application of a session.

    Args:
        desk: Of the session.
        access: Who may ask; the console needs the experimenter's token.
        folder: The pages' files; those of the package if None.
    """
    pages = {"/": "session.html", "/console": "console.html", "/drive": "index.html"}
    routes = [
        *_drive_routes(desk, access),
        *_participant_routes(desk),
        *_console_routes(Console(desk), access),
        *(Route(path, _page(name, access)) for path, name in pages.items()),
    ]
    files = static_folder() if folder is None else folder
    return Guard(application(routes, files), access)


def _drive_routes(desk: Desk, access: Access) -> list[BaseRoute]:
    """Of the drive that is on: what `costeer drive` answers."""

    async def answer_hello(request: Request) -> Response:
        drive = desk.drive_on_show
        if drive is None or drive.pages is None:
            return _refused(409, "no drive is on")
        return json_response(hello(drive.pages, role_of(access, request)))

    async def answer_socket(websocket: WebSocket) -> None:
        drive = desk.drive_on_show
        if drive is None or drive.pages is None:
            await websocket.close(1013)
            return
        await hold(websocket, drive.pages, role_of(access, websocket))

    return [Route("/api/hello", answer_hello), WebSocketRoute("/ws", answer_socket)]


def _participant_routes(desk: Desk) -> list[BaseRoute]:
    """What the participant's page asks."""

    async def answer_state(request: Request) -> Response:
        desk.page_seen = time.monotonic()
        desk.hear_pictures(request.query_params.get("pictures", ""))
        return await _answered(desk.state)

    def takes(does: Callable[[str, dict[str, Any]], dict[str, Any]]) -> Any:
        async def answer(request: Request) -> Response:
            body = await _body(request)
            if isinstance(body, Response):
                return body
            return await _answered(
                lambda: does(str(body.get("participant")), body), desk
            )

        return answer

    def answers(who: str, body: dict[str, Any]) -> dict[str, Any]:
        given = body.get("answers")
        if not isinstance(given, Mapping):
            raise ValueError("answers are no names and values")
        return desk.answers(who, str(body.get("step")), given)

    does = {
        "next": lambda who, body: desk.next(who, str(body.get("step"))),
        "answers": answers,
        "stop": lambda who, body: desk.stop_taking_part(
            who, body.get("delete") is True
        ),
        "resume": lambda who, body: desk.take_part_again(who),
    }
    return [
        Route("/api/session", answer_state),
        *(
            Route(f"/api/session/{name}", takes(work), methods=["POST"])
            for name, work in does.items()
        ),
    ]


def _console_routes(console: Console, access: Access) -> list[BaseRoute]:
    """What the console asks; only with the experimenter's token."""

    async def answer_console(request: Request) -> Response:
        if not is_experimenter(access, request):
            return _refused(403, "only the experimenter may see the console")
        return await _answered(console.shown)

    async def answer_action(request: Request) -> Response:
        if not is_experimenter(access, request):
            return _refused(403, "only the experimenter may do that")
        body = await _body(request)
        if isinstance(body, Response):
            return body
        action = request.path_params["action"]
        return await _answered(lambda: console.act(action, body))

    return [
        Route("/api/console", answer_console),
        Route("/api/console/{action}", answer_action, methods=["POST"]),
    ]


def _page(name: str, access: Access) -> Callable[[Request], Any]:
    """Answers with a page; the console only to the experimenter."""

    async def answer(request: Request) -> Response:
        if name == "console.html" and not is_experimenter(access, request):
            return _refused(403, "open the experimenter's address that costeer printed")
        file = file_in(request.app.state.folder, name)
        if file is None:
            return Response("The page is missing. Install costeer again.\n", 503)
        return file_response(file)

    return answer


async def _body(request: Request) -> dict[str, Any] | Response:
    """The JSON object of a request, or the answer that refuses it."""
    if request.headers.get("content-type", "").partition(";")[0] != "application/json":
        return _refused(415, "send JSON")
    whole = b""
    async for part in request.stream():
        whole += part
        if len(whole) > LARGEST_BODY:
            return _refused(413, f"at most {LARGEST_BODY} bytes are read")
    try:
        found = json.loads(whole)
    except (ValueError, RecursionError):
        return _refused(400, "this is no JSON")
    return found if isinstance(found, dict) else _refused(400, "send a JSON object")


async def _answered(
    work: Callable[[], dict[str, Any]], desk: Desk | None = None
) -> Response:
    """What a piece of work gives, or why it cannot be done.

    Args:
        work: Run in a thread: it may wait for the disk.
        desk: Whose state is sent with a refusal for another step.
    """
    try:
        return json_response(await run_in_threadpool(work))
    except OutOfStepError as error:
        now = {} if desk is None else {"state": await run_in_threadpool(desk.state)}
        return _refused(409, str(error), now)
    except StoreError as error:
        return _refused(507, str(error))
    except AnswersError as error:
        return _refused(400, str(error), {"problems": error.codes()})
    except (ValueError, OSError) as error:
        return _refused(400, str(error))


def _refused(code: int, text: str, more: dict[str, Any] | None = None) -> Response:
    answer = json_response({"type": "error", "text": text, **(more or {})})
    answer.status_code = code
    return answer
