"""Half requests, bad chunks and silence: the server lets them go and says nothing."""

from __future__ import annotations

import json
import socket as sockets
import time
from collections.abc import Iterator

import pytest

from costeer.web import impatient
from costeer.web.app import drive_app
from costeer.web.serving import Running
from tests.waiting import PATIENCE
from tests.web.served import FakeSession, fetch, page_files, served, socket_of


@pytest.fixture(scope="module")
def running(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Running]:
    static = page_files(tmp_path_factory.mktemp("page"))
    with served(lambda access: drive_app(FakeSession(), access, static)) as told:
        yield told


def raw(running: Running, text: bytes) -> sockets.socket:
    """A plain connection on which something was sent."""
    made = sockets.create_connection(("127.0.0.1", running.access.port), PATIENCE)
    made.sendall(text)
    return made


@pytest.mark.parametrize("chunk", [b"zz\r\nabc\r\n0\r\n\r\n", b"-5\r\nabc\r\n"])
def test_a_bad_chunk_is_refused_without_a_word_in_the_log(
    running: Running, chunk: bytes, caplog: pytest.LogCaptureFixture
) -> None:
    asked = b"GET / HTTP/1.1\r\nHost: 127.0.0.1\r\nTransfer-Encoding: chunked\r\n\r\n"
    with raw(running, asked + chunk) as connection:
        assert connection.recv(100).startswith(b"HTTP/1.1 400")
    assert fetch(running, "/").status == 200
    assert not [record for record in caplog.records if record.exc_info]


@pytest.mark.parametrize("half", [b"", b"GET / HTTP/1.1\r\nHost: 127"])
def test_half_a_request_does_not_keep_a_connection_open(
    running: Running, monkeypatch: pytest.MonkeyPatch, half: bytes
) -> None:
    monkeypatch.setattr(impatient, "PATIENCE", 0.1)
    with raw(running, half) as connection:
        assert connection.recv(100) == b""
    whole = b"GET / HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n"
    with raw(running, whole + b"GET / HT") as connection:
        while connection.recv(1000):
            pass


def test_a_socket_outlives_the_patience_for_requests(
    running: Running, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(impatient, "PATIENCE", 0.05)
    with socket_of(running) as socket:
        socket.recv(PATIENCE)
        time.sleep(0.3)
        socket.send('{"type":"ping","t":1}')
        assert json.loads(socket.recv(PATIENCE))["type"] == "pong"
