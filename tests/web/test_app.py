"""The server of a drive: page, files, hello, socket; what is foreign stays out."""

from __future__ import annotations

import asyncio
import json
import socket as sockets
import struct
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import ClientConnection

from costeer.web import intake, serving
from costeer.web.app import MOST_PAGES, drive_app
from costeer.web.messages import Input, Set, Start
from costeer.web.pages import file_in, start_page, static_folder
from costeer.web.serving import Ending, Running, listening
from costeer.web.session import MOST_FRAMES, Outbox
from tests.waiting import PATIENCE, wait_for
from tests.web.attacks import PATHS
from tests.web.served import FakeSession, fetch, page_files, served, socket_of


@pytest.fixture(scope="module")
def static(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return page_files(tmp_path_factory.mktemp("page"))


@pytest.fixture(scope="module")
def session() -> FakeSession:
    return FakeSession()


@pytest.fixture(scope="module")
def running(session: FakeSession, static: Path) -> Iterator[Running]:
    with served(lambda access: drive_app(session, access, static)) as told:
        yield told


def told(socket: ClientConnection) -> Any:
    """The next text message."""
    return json.loads(socket.recv(PATIENCE))


def experimenter(running: Running) -> str:
    return f"?experimenter={running.access.experimenter_token}"


def test_page_and_files_come_with_their_types(running: Running) -> None:
    page = fetch(running, "/")
    assert (page.status, page.body) == (200, b"<p>the page</p>")
    assert page.headers["Content-Type"].startswith("text/html")
    script = fetch(running, "/main.js?v=1")
    assert (script.status, script.body) == (200, b"export {};")
    assert script.headers["Content-Type"].startswith("text/javascript")


@pytest.mark.parametrize("path", PATHS)
def test_no_path_leads_out_of_the_pages_folder(running: Running, path: str) -> None:
    answer = fetch(running, path)
    assert answer.status == 404
    assert b"secret" not in answer.body


def test_a_link_does_not_lead_out_of_the_folder(static: Path) -> None:
    assert file_in(static, "main.js") == (static / "main.js").resolve()
    (static / "link.txt").symlink_to(static.parent / "secret.txt")
    assert file_in(static, "link.txt") is None


def test_a_page_without_its_libraries_says_so(tmp_path: Path) -> None:
    static = page_files(tmp_path)
    (static / "vendor").rmdir()
    assert start_page(static) == (static / "missing.html").resolve()
    (static / "missing.html").unlink()
    with served(lambda access: drive_app(FakeSession(), access, static)) as running:
        answer = fetch(running, "/")
    assert (answer.status, b"make page" in answer.body) == (503, True)


def test_browsers_are_told_what_to_forbid(running: Running) -> None:
    for path in ("/", "/nothing.js", "/api/hello", "/api/hello?experimenter=no"):
        headers = fetch(running, path).headers
        policy = headers["Content-Security-Policy"]
        assert policy.startswith("default-src 'self'; img-src 'self' data:; ")
        assert "script-src" not in policy
        assert headers["X-Content-Type-Options"] == "nosniff"
        assert headers["Referrer-Policy"] == "no-referrer"
        assert headers["Cache-Control"] == "no-store"
    policy = fetch(running, "/").headers["Content-Security-Policy"]
    assert f"ws://127.0.0.1:{running.access.port} " in policy


def test_hello_tells_the_role_and_has_no_infinity(running: Running) -> None:
    hello = json.loads(fetch(running, "/api/hello").body)
    assert hello == {
        "type": "hello",
        "mode": "drive",
        "columns": ["time"],
        "low": None,
        "role": "driver",
    }
    other = json.loads(fetch(running, f"/api/hello{experimenter(running)}").body)
    assert other["role"] == "experimenter"


def test_a_socket_says_hello_answers_pings_and_applies_messages(
    running: Running, session: FakeSession
) -> None:
    session.applied.clear()
    with socket_of(running) as socket:
        assert told(socket)["type"] == "hello"
        socket.send('{"type":"ping","t":41.5}')
        pong = told(socket)
        assert (pong["type"], pong["t"], pong["server_time"] > 0) == (
            "pong",
            41.5,
            True,
        )
        socket.send('{"type":"start"}')
        assert told(socket) == {"type": "state", "number": 1}
        socket.send(
            '{"type":"input","sequence":3,"steer":0.5,"accelerator":1,"brake":0}'
        )
        assert told(socket)["number"] == 2
    assert session.applied == [
        ("driver", Start()),
        ("driver", Input(sequence=3, steer=0.5, accelerator=1.0, brake=0.0)),
    ]


def test_only_the_experimenter_tunes(running: Running, session: FakeSession) -> None:
    session.applied.clear()
    tune = '{"type":"set","name":"gain","value":2}'
    with socket_of(running) as socket:
        told(socket)
        socket.send(tune)
        assert "only the experimenter" in told(socket)["text"]
    with socket_of(running, experimenter(running)) as socket:
        told(socket)
        socket.send(tune)
        assert told(socket)["type"] == "state"
        socket.send('{"type":"set","name":"unknown","value":2}')
        assert told(socket) == {
            "type": "error",
            "text": "gain 'unknown' is not known; choose another",
        }
    assert session.applied[0] == ("experimenter", Set("gain", 2.0))


@pytest.mark.parametrize("word", ["restart", "stop"])
def test_a_driver_neither_restarts_nor_stops(
    running: Running, session: FakeSession, word: str
) -> None:
    session.applied.clear()
    with socket_of(running) as socket:
        told(socket)
        socket.send(f'{{"type":"{word}"}}')
        assert "only the experimenter" in told(socket)["text"]
    assert session.applied == []


def test_frames_and_markers_reach_every_page(
    running: Running, session: FakeSession
) -> None:
    frame = struct.pack("<2d", 1.0, float("nan"))
    with socket_of(running) as one, socket_of(running) as two:
        told(one), told(two)
        session.broadcast.send_frame(frame)
        assert (one.recv(PATIENCE), two.recv(PATIENCE)) == (frame, frame)
        session.broadcast.send({"type": "marker", "time": float("nan")})
        assert told(one) == told(two) == {"type": "marker", "time": None}


@pytest.mark.parametrize(
    "sent", ["nonsense", b"binary", '{"type":"start"}'.ljust(2000)]
)
def test_twenty_refused_messages_close_the_socket(
    running: Running, sent: str | bytes
) -> None:
    with socket_of(running) as socket:
        told(socket)
        for _ in range(20):
            socket.send(sent)
        answers = [told(socket)["type"] for _ in range(20)]
        with pytest.raises(ConnectionClosed) as caught:
            socket.recv(PATIENCE)
    assert answers == ["error"] * 20
    assert caught.value.rcvd is not None
    assert caught.value.rcvd.code == 1008


def test_a_page_that_says_too_much_is_shut_out(
    running: Running, session: FakeSession, monkeypatch: pytest.MonkeyPatch
) -> None:
    # Slower than any machine is, so that the clock does not decide.
    few = intake.IntakeParameters(message_rate=1e-3, burst=5.0)
    monkeypatch.setattr(intake, "IntakeParameters", lambda: few)
    session.applied.clear()
    with socket_of(running) as socket:
        told(socket)
        for _ in range(25):
            socket.send('{"type":"start"}')
        answers = [told(socket)["type"] for _ in range(25)]
        with pytest.raises(ConnectionClosed):
            socket.recv(PATIENCE)
    assert answers == ["state"] * 5 + ["error"] * 20
    assert len(session.applied) == 5


def test_a_huge_message_closes_the_socket_unread(running: Running) -> None:
    with socket_of(running) as socket:
        told(socket)
        socket.send("x" * 100_000)
        with pytest.raises(ConnectionClosed) as caught:
            socket.recv(PATIENCE)
    assert caught.value.rcvd is not None
    assert caught.value.rcvd.code == 1009


def test_the_session_hears_that_a_page_left(static: Path) -> None:
    session = FakeSession()  # no page of another test can leave it
    with served(lambda access: drive_app(session, access, static)) as running:
        with socket_of(running) as socket:
            told(socket)
            assert session.left == []
        wait_for(lambda: session.left)
    assert session.left == ["driver"]


def test_a_page_that_may_not_join_is_told_why(static: Path) -> None:
    session = FakeSession()
    session.full = True
    with (
        served(lambda access: drive_app(session, access, static)) as running,
        socket_of(running) as socket,
    ):
        assert "somebody drives already" in told(socket)["text"]
        with pytest.raises(ConnectionClosed):
            socket.recv(PATIENCE)
    assert (session.left, session.broadcast.num_pages) == ([], 0)


def test_no_more_pages_than_allowed(running: Running, session: FakeSession) -> None:
    wait_for(lambda: not session.broadcast.num_pages)  # those of other tests are gone

    async def crowd() -> list[Outbox]:
        return [session.broadcast.join() for _ in range(MOST_PAGES)]

    outboxes = asyncio.run(crowd())
    with socket_of(running) as socket:
        assert "pages are open" in told(socket)["text"]
    for outbox in outboxes:
        session.broadcast.leave(outbox)


def test_a_slow_page_loses_old_frames_but_no_text() -> None:
    async def late() -> list[str | bytes]:
        outbox = Outbox()
        for number in range(MOST_FRAMES + 5):
            outbox.put_frame(bytes([number]))
            outbox.put_text(str(number))
        return await outbox.take()

    *texts, frames = asyncio.run(late())
    assert texts == [str(number) for number in range(MOST_FRAMES + 5)]
    assert frames == bytes(range(5, MOST_FRAMES + 5))


def test_pages_are_told_before_their_server_ends(static: Path) -> None:
    session, ends = FakeSession(), []
    ending = Ending(
        lambda: ends.append("noted"),
        lambda: session.broadcast.send({"type": "farewell"}),
    )
    with (
        served(lambda a: drive_app(session, a, static), ending=ending) as running,
        socket_of(running) as socket,
    ):
        told(socket)
        running.stop()
        assert told(socket)["type"] == "farewell"
        assert (ends, session.left) == (["noted"], [])


def test_a_stopped_server_lets_its_sockets_go(static: Path) -> None:
    session = FakeSession()
    with (
        served(lambda access: drive_app(session, access, static)) as running,
        socket_of(running) as socket,
    ):
        told(socket)
        running.stop()
        with pytest.raises(ConnectionClosed):
            socket.recv(PATIENCE)
    assert session.left == ["driver"]


def test_a_taken_port_is_told_with_the_way_out() -> None:
    with listening("127.0.0.1", 0) as first:
        port = first.getsockname()[1]
        with pytest.raises(ValueError, match=f"port {port} is taken.*--port 0"):
            listening("127.0.0.1", port)


@pytest.mark.parametrize("host", ["203.0.113.7", "no.such.host.invalid", "a" * 80])
def test_a_host_that_is_not_ours_is_told(
    host: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    def unknown(*_: object, **__: object) -> object:
        raise sockets.gaierror(-2, "Name or service not known")

    if not host[0].isdigit():  # asks no name server
        monkeypatch.setattr(serving.socket, "getaddrinfo", unknown)
    with pytest.raises(ValueError, match="no address of this computer"):
        listening(host, 0)


def test_no_browser_is_opened_without_a_screen(monkeypatch: pytest.MonkeyPatch) -> None:
    opened: list[str] = []
    monkeypatch.setattr(serving.webbrowser, "open", opened.append)
    monkeypatch.setattr(serving.sys, "platform", "linux")
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    assert serving.open_page("http://127.0.0.1/") is None
    assert opened == []
    monkeypatch.setenv("DISPLAY", ":0")
    thread = serving.open_page("http://127.0.0.1/")
    assert thread is not None
    thread.join(PATIENCE)
    assert opened == ["http://127.0.0.1/"]


def test_the_shipped_page_is_found() -> None:
    assert static_folder().parts[-3:] == ("costeer", "web", "static")
