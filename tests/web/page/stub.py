"""A server that speaks the page's protocol and drives straight on."""

from __future__ import annotations

import asyncio
import contextlib
import json
import mimetypes
import socket
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import uvicorn
from starlette.applications import Starlette
from starlette.requests import Request
from starlette.responses import JSONResponse, Response
from starlette.routing import Mount, Route, WebSocketRoute
from starlette.staticfiles import StaticFiles
from starlette.types import ASGIApp, Message, Receive, Scope, Send
from starlette.websockets import WebSocket, WebSocketDisconnect

from costeer.records.row import ROW_COLUMNS
from costeer.runtime.states import page_tables

STATIC = Path(__file__).parents[3] / "src" / "costeer" / "web" / "static"
EXTRA = ("run_state", "fault", "input_sequence", "wheel_time", "sent_time", "indicator")
STEPPED = ("lane", "mode", "event", *EXTRA)
COLUMNS = (*ROW_COLUMNS, *EXTRA)
RATE = 60.0
SPEED = 20.0
POLICY = b"default-src 'self'; img-src 'self' data:; style-src 'self' 'unsafe-inline'"

Json = dict[str, Any]  # Any: a message as JSON gives it


def row(seconds: float, **others: float) -> np.ndarray:
    """A frame after some seconds on the left lane, at a constant speed."""
    values = dict.fromkeys(COLUMNS, np.nan)
    values |= {"time": seconds, "longitudinal_position": 1000.0 + SPEED * seconds}
    values |= {"lateral_position": 0.0, "yaw_angle": 0.0, "lane": 1.0, "mode": 1.0}
    values |= {"longitudinal_velocity": SPEED, "steering_wheel_angle": 0.2, **others}
    return np.array([values[name] for name in COLUMNS])


class Stub:
    """State of the stub, and what the page told it."""

    def __init__(self) -> None:
        self.heard: list[Json] = []
        self.frame: dict[str, float] = dict.fromkeys(EXTRA, 0.0)
        self.seconds = 0.0
        self.role = "driver"
        self.show_signals = False
        self.mode = "drive"
        self.tables: Json = dict(page_tables())
        self.is_halted = False
        self.is_loop_gone = False
        self.refuses = ""
        self._to_say: list[Json] = []

    def say(self, message: Json) -> None:
        """Have a text message sent with the next frame."""
        self._to_say.append(message)

    def said(self) -> list[Json]:
        """What is to be sent now."""
        now, self._to_say = self._to_say, []
        return now

    def hello(self) -> Json:
        """First message of the server."""
        road = {"lane_width": 3.5, "num_lanes": 2, "length": 8000.0}
        tunable = {"name": "strength", "unit": "-", "low": 0.0, "high": 1.0}
        return {
            "type": "hello",
            "mode": self.mode,
            "role": self.role,
            "columns": COLUMNS,
            "stepped": STEPPED,
            "rate": RATE,
            "road": {**road, "overtaking_side": -1.0},
            "conditions": ["manual", "strong-normal"],
            "condition": "strong-normal",
            "methods": ["ibhs"],
            "method": "ibhs",
            "tunables": [{**tunable, "value": 1.0, "label": "Strength"}],
            "input": "keyboard",
            "show_signals": self.show_signals,
            "title": "a drive straight on",
            "markers": [{"time": 5.0, "kind": "started", "text": "started"}],
            **self.tables,
        }

    def record(self) -> np.ndarray:
        """Ten seconds of driving, for replay."""
        return np.stack([row(n / RATE) for n in range(601)])

    def hear(self, message: Json) -> Json | None:
        """Take in a message of the page; return the answer, if there is one."""
        kind = message["type"]
        self.heard.append(message)
        if kind == "input":
            self.frame["input_sequence"] = message["sequence"]
        if kind in {"start", "resume"}:
            self.frame["run_state"] = 1.0
        if kind == "pause":
            self.frame["run_state"] = 2.0
        if kind == "indicator":
            self.frame["indicator"] = message["side"]
        if kind == "ping":
            now = time.monotonic()
            return {"type": "pong", "t": message["t"], "server_time": now}
        return None

    def of_type(self, kind: str) -> list[Json]:
        """Messages of one type that were heard."""
        return [message for message in self.heard if message["type"] == kind]


async def send_frames(stub: Stub, link: WebSocket) -> None:
    """Send frames at their rate; time passes only while the trial runs."""
    while True:
        while stub.is_halted or stub.is_loop_gone:
            await asyncio.sleep(1.0 / RATE)
        for message in stub.said():
            await link.send_text(json.dumps(message))
        now = time.monotonic()
        stub.seconds += (stub.frame["run_state"] == 1.0) / RATE
        frame = {**stub.frame, "wheel_time": now, "sent_time": now}
        await link.send_bytes(row(stub.seconds, **frame).astype("<f8").tobytes())
        await asyncio.sleep(1.0 / RATE)


def policed(app: ASGIApp) -> ASGIApp:
    """The app with the content policy of the real server."""

    async def call(scope: Scope, receive: Receive, send: Send) -> None:
        async def reply(message: Message) -> None:
            if message["type"] == "http.response.start":
                policy = (b"content-security-policy", POLICY)
                message["headers"] = [*message["headers"], policy]
            await send(message)

        await app(scope, receive, reply)

    return call


def stub_app(stub: Stub) -> ASGIApp:
    """Pages, hello, record and socket."""

    async def hello(request: Request) -> Response:
        return JSONResponse(stub.hello())

    async def record(request: Request) -> Response:
        return Response(stub.record().astype("<f8").tobytes())

    async def speak(link: WebSocket) -> None:
        await link.accept()
        if stub.refuses:
            refusal = {"type": "error", "text": stub.refuses}
            await link.send_text(json.dumps(refusal))
            await link.close(1008)
            return
        await link.send_text(json.dumps(stub.hello()))
        frames = asyncio.create_task(send_frames(stub, link))
        with contextlib.suppress(WebSocketDisconnect):
            while True:
                answer = stub.hear(json.loads(await link.receive_text()))
                if answer and not stub.is_halted:
                    await link.send_text(json.dumps(answer))
        frames.cancel()
        with contextlib.suppress(asyncio.CancelledError, Exception):
            await frames

    routes = [
        Route("/api/hello", hello),
        Route("/api/record", record),
        WebSocketRoute("/ws", speak),
        Mount("/", StaticFiles(directory=STATIC, html=True)),
    ]
    return policed(Starlette(routes=routes))


@contextlib.contextmanager
def served(stub: Stub) -> Iterator[str]:
    """Address of a running stub."""
    mimetypes.add_type("text/javascript", ".js")
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    settings = uvicorn.Config(
        stub_app(stub), port=port, log_level="error", ws="websockets-sansio"
    )
    server = uvicorn.Server(settings)
    thread = threading.Thread(target=server.run, daemon=True)
    thread.start()
    while not server.started and thread.is_alive():
        time.sleep(0.01)
    try:
        yield f"http://127.0.0.1:{port}"
    finally:
        server.should_exit = True
        thread.join(10.0)
