"""Half requests, bad chunks and silence: the server lets them go and says nothing."""

from __future__ import annotations

import json
import time
from collections.abc import Iterator

import pytest

from costeer.web import impatient
from costeer.web.app import drive_app
from costeer.web.serving import Running
from tests.waiting import PATIENCE
from tests.web.attacks import BAD_CHUNKS, CHUNKED, HALVES
from tests.web.served import (
    FakeSession,
    Told,
    fetch,
    page_files,
    raw,
    served,
    socket_of,
)


@pytest.fixture(scope="module")
def running(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Running]:
    static = page_files(tmp_path_factory.mktemp("page"))
    with served(lambda access: drive_app(FakeSession(), access, static)) as told:
        yield told


@pytest.mark.parametrize("chunk", BAD_CHUNKS)
def test_a_bad_chunk_is_refused_without_a_word_in_the_log(
    running: Running, chunk: bytes
) -> None:
    with Told() as told, raw(running, CHUNKED + chunk) as connection:
        assert connection.recv(100).startswith(b"HTTP/1.1 400")
        assert fetch(running, "/").status == 200
    assert told.tracebacks == []


@pytest.mark.parametrize("half", HALVES)
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
