"""Who may ask: own pages, and who has the token; everyone else is told no."""

from __future__ import annotations

import pytest
from starlette.requests import HTTPConnection
from websockets.exceptions import InvalidStatus

from costeer.web.app import drive_app
from costeer.web.security import (
    Access,
    access_for,
    is_loopback,
    is_own_name,
    refusal,
    role_of,
)
from costeer.web.serving import page_address
from tests.web.attacks import FOREIGN_HOSTS, FOREIGN_ORIGINS
from tests.web.served import FakeSession, fetch, own_origin, served, socket_of

LOCAL = Access("127.0.0.1", 8700, None, "boss")
OPEN = Access("0.0.0.0", 8700, "sesame", "boss", ("lab-pc", "lab-pc.local"))


def asking(
    query: str = "", kind: str = "http", host: str = "127.0.0.1:8700", **headers: str
) -> HTTPConnection:
    """A request as the server sees it; headers with the underscores of Python."""
    given = {"host": host} | headers
    pairs = [(name.encode(), text.encode()) for name, text in given.items()]
    scope = {
        "type": "websocket" if kind == "ws" else "http",
        "scheme": kind,
        "path": "/",
        "query_string": query.encode(),
        "headers": pairs,
        "server": ("127.0.0.1", 8700),
    }
    return HTTPConnection(scope)


@pytest.mark.parametrize(
    "host", ["127.0.0.1:8700", "localhost:8700", "LOCALHOST", "[::1]:9", "127.0.0.2"]
)
def test_a_loopback_server_answers_to_the_names_of_loopback(host: str) -> None:
    assert is_own_name(LOCAL, host)
    assert refusal(LOCAL, asking(host=host)) == ""


@pytest.mark.parametrize(
    "host",
    [*FOREIGN_HOSTS, "", "127.0.0.1\r\nX: 1"],
)
def test_it_answers_to_no_other_name(host: str) -> None:
    assert not is_own_name(LOCAL, host)
    assert "name" in refusal(LOCAL, asking(host=host))


def test_an_open_server_answers_to_addresses_and_its_own_names() -> None:
    own = ["192.168.1.2:8700", "lab-pc:8700", "lab-pc.local", "[2001:db8::1]:8700"]
    assert all(is_own_name(OPEN, host) for host in own)
    assert not is_own_name(OPEN, "evil.example:8700")
    named = Access("lab.example", 8700, "sesame", "boss")
    assert is_own_name(named, "lab.example:8700")


def test_two_host_headers_are_refused() -> None:
    request = asking()
    request.scope["headers"].append((b"host", b"localhost"))
    assert refusal(LOCAL, request)


def test_an_open_server_asks_everyone_for_the_token() -> None:
    assert "token" in refusal(OPEN, asking())
    assert "token" in refusal(OPEN, asking("token=sesam"))
    assert "token" in refusal(OPEN, asking("token="))
    assert refusal(OPEN, asking("token=sesame")) == ""
    assert refusal(OPEN, asking("experimenter=boss")) == ""
    assert refusal(OPEN, asking(cookie="costeer_8700=sesame")) == ""
    assert refusal(OPEN, asking(cookie="costeer_8701=sesame"))


def test_a_token_that_is_no_ascii_is_merely_wrong() -> None:
    assert "token" in refusal(OPEN, asking("token=%C3%A4%FF"))


def test_a_server_without_tokens_makes_nobody_experimenter() -> None:
    bare = Access("127.0.0.1", 8700)
    assert role_of(bare, asking("experimenter=")) == "driver"
    assert refusal(bare, asking("experimenter=x"))


def test_the_experimenter_has_the_experimenters_token() -> None:
    assert role_of(LOCAL, asking("experimenter=boss")) == "experimenter"
    assert role_of(LOCAL, asking("token=boss")) == "driver"
    assert "experimenter" in refusal(LOCAL, asking("experimenter=bos"))
    # The cookie lets in, no more.
    assert role_of(OPEN, asking(cookie="costeer_8700=boss")) == "driver"


@pytest.mark.parametrize(
    "origin",
    [*FOREIGN_ORIGINS, "https://127.0.0.1:8700", "http://127.0.0.1:8701"],
)
def test_a_foreign_origin_is_refused_even_with_the_token(origin: str) -> None:
    for kind in ("ws", "http"):
        asked = asking("token=sesame", kind, origin=origin)
        assert "another site" in refusal(OPEN, asked)


def test_a_socket_needs_the_own_origin_or_a_token() -> None:
    assert refusal(LOCAL, asking(kind="ws", origin="http://127.0.0.1:8700")) == ""
    assert "socket" in refusal(LOCAL, asking(kind="ws"))
    assert refusal(LOCAL, asking("experimenter=boss", "ws")) == ""
    assert refusal(OPEN, asking("token=sesame", "ws")) == ""


def test_tokens_are_made_where_they_are_asked_and_differ() -> None:
    assert access_for().token is None
    one, two = access_for("0.0.0.0"), access_for("0.0.0.0")
    secrets = {one.token, two.token, one.experimenter_token, two.experimenter_token}
    assert len(secrets) == 4
    assert all(secret and len(secret) >= 20 for secret in secrets)


@pytest.mark.parametrize("port", [-1, 65536])
def test_a_port_that_is_none_is_refused(port: int) -> None:
    with pytest.raises(ValueError, match="from 1 to 65535"):
        access_for(port=port)


def test_loopback_is_what_only_this_computer_reaches() -> None:
    assert all(map(is_loopback, ["127.0.0.1", "::1", "localhost", "127.9.9.9"]))
    assert not any(map(is_loopback, ["0.0.0.0", "::", "192.168.1.2", "example.org"]))


def test_the_printed_address_holds_what_is_asked() -> None:
    assert page_address(LOCAL) == "http://127.0.0.1:8700/"
    assert page_address(LOCAL, experimenter=True).endswith("/?experimenter=boss")
    assert page_address(OPEN) == "http://lab-pc:8700/?token=sesame"
    assert page_address(Access("::1", 80)) == "http://[::1]:80/"


def test_the_server_refuses_with_a_sentence_and_lets_the_cookie_in() -> None:
    # Listens on loopback, but asks for the token, as with another host.
    asked = Access("127.0.0.1", 0, "sesame", "boss")
    session = FakeSession()
    with served(lambda access: drive_app(session, access), asked) as running:
        without = fetch(running, "/api/hello")
        assert (without.status, without.headers["Set-Cookie"]) == (403, None)
        assert without.body.decode().startswith("The token is missing or wrong.")
        first = fetch(running, "/api/hello?token=sesame")
        cookie = first.headers["Set-Cookie"]
        assert first.status == 200
        assert cookie.endswith("; HttpOnly; SameSite=Strict; Path=/")
        later = fetch(running, "/api/hello", Cookie=cookie.partition(";")[0])
        assert later.status == 200


def test_the_server_refuses_sockets_of_other_sites() -> None:
    session = FakeSession()
    with served(lambda access: drive_app(session, access)) as running:
        for origin in ("http://evil.example", None):
            with (
                pytest.raises(InvalidStatus) as caught,
                socket_of(running, origin=origin),
            ):
                pass
            assert caught.value.response.status_code == 403
            assert caught.value.response.body.endswith(b".\n")
        rebound = fetch(running, "/api/hello", Host="evil.example")
        assert (rebound.status, session.joined) == (403, [])
        with socket_of(running, origin=own_origin(running)) as socket:
            socket.recv()
    assert session.joined == ["driver"]


@pytest.mark.parametrize("order", [1, -1])
def test_one_right_origin_among_several_is_not_enough(order: int) -> None:
    asked = asking(kind="ws")
    origins = ["http://127.0.0.1:8700", "http://evil.example"][::order]
    asked.scope["headers"] += [(b"origin", origin.encode()) for origin in origins]
    assert "another site" in refusal(LOCAL, HTTPConnection(asked.scope))
