"""What gets into the server, and out of what it shows, that should not.

    python -m benchmarks.attacks [NUMBER]

Starts the server of a drive and that of a replay and tries on them: foreign names and
origins, no token and NUMBER (200) nearly right ones, paths out of the page's folder (as
many at random), requests that are huge, half, badly chunked or random bytes, messages
that are none or not for a driver. Then texts of HTML in a record that is replayed, and
cells that a spreadsheet would run in the tables that costeer writes. Prints how many
were tried, how many were let in, answers of 500 and tracebacks. Exit code 1 if any.
"""

from __future__ import annotations

import csv
import io
import json
import random
import socket
import sys
import tempfile
from collections.abc import Iterator
from contextlib import suppress
from functools import partial
from pathlib import Path
from typing import NamedTuple

from websockets.exceptions import WebSocketException

from costeer.cli.many import write_rows
from costeer.pages.record import table
from costeer.records.record import TrialRecord
from costeer.study.trial_tables import write_csv
from costeer.web.app import drive_app, replay_app
from costeer.web.messages import EXPERIMENTER_ONLY
from costeer.web.pages import static_folder
from costeer.web.replay import replay_of
from costeer.web.security import Access
from costeer.web.serving import Running
from tests.study.synthetic import synthetic_record
from tests.web.attacks import (
    BAD_CHUNKS,
    CHUNKED,
    EVIL_HTML,
    FOREIGN_HOSTS,
    FOREIGN_ORIGINS,
    FORMULAS,
    HALVES,
    PATHS,
)
from tests.web.served import (
    Answer,
    FakeSession,
    Told,
    fetch,
    own_origin,
    page_files,
    raw,
    served,
    socket_of,
)

SEED = 1
TOKEN, EXPERIMENTER = "sesame-open-thyself", "boss-of-the-experiment"
GUARDED = Access("127.0.0.1", 0, TOKEN, EXPERIMENTER)
PIECES = ("..", ".", "%2e%2e", "%252e%252e", "%2f", "%5c", "\\", "//", "%00", "vendor")
PIECES += ("secret.txt", ".hidden", "etc", "passwd", "~root", "file:", "%c0%ae")
SECRETS = (b"secret", b"hidden", b"root:")
WRITERS = ("innerHTML", "outerHTML", "insertAdjacentHTML", "document.write", "eval(")
"""Ways of a page's script to make HTML or code of a text."""


class Tally(NamedTuple):
    """What became of attacks of one sort."""

    name: str
    tried: int
    let_in: int
    errors: int


def counted(name: str, answers: Iterator[tuple[bool, int]]) -> Tally:
    """Count answers: whether each was let in, and its status (0 for none)."""
    every = list(answers)
    let_in = sum(is_in for is_in, _ in every)
    return Tally(name, len(every), let_in, sum(status >= 500 for _, status in every))


def opens(running: Running, query: str = "", origin: str | None = None) -> bool:
    """Whether a socket is opened."""
    with (
        suppress(WebSocketException, OSError),
        socket_of(running, query, origin=origin) as there,
    ):
        return json.loads(there.recv(5.0))["type"] == "hello"
    return False


def foreigners(running: Running) -> Iterator[tuple[bool, int]]:
    """Other names and other origins, for pages, data and the socket."""
    for path in ("/", "/api/hello", "/main.js"):
        for host in FOREIGN_HOSTS:
            status = fetch(running, path, Host=host).status
            yield status == 200, status
        for origin in FOREIGN_ORIGINS:
            status = fetch(running, path, Origin=origin).status
            yield status == 200, status
    for origin in (*FOREIGN_ORIGINS, None):
        yield opens(running, origin=origin), 0


def near(draw: random.Random, token: str) -> str:
    """A token that is nearly right."""
    place = draw.randrange(len(token))
    return draw.choice(
        (
            token[:place],
            token[:place] + draw.choice("abcXYZ-_0%") + token[place + 1 :] + "~",
            token.upper(),
            token[::-1],
            token + "%00",
        )
    )


def strangers(running: Running, number: int) -> Iterator[tuple[bool, int]]:
    """No token, and nearly right ones, in the address and as a cookie."""
    draw = random.Random(SEED)
    cookie = f"costeer_{running.access.port}"
    queries = ["", "?token=", "?experimenter=", f"?Token={TOKEN}", f"?t={TOKEN}"]
    queries += [f"?token={near(draw, TOKEN)}" for _ in range(number)]
    queries += [f"?experimenter={near(draw, EXPERIMENTER)}" for _ in range(number)]
    for query in queries:
        status = fetch(running, "/api/hello" + query).status
        yield status == 200, status
    for _ in range(number):
        pair = f"{draw.choice((cookie, 'costeer', cookie + '0'))}={near(draw, TOKEN)}"
        status = fetch(running, "/api/hello", Cookie=pair).status
        yield status == 200, status
    for query in queries[:20]:
        yield opens(running, query), 0


def climbers(running: Running, number: int) -> Iterator[tuple[bool, int]]:
    """Paths out of the folder of the page."""
    draw = random.Random(SEED)
    lengths = [draw.randrange(1, 8) for _ in range(number)]
    made = ["/" + "/".join(draw.choices(PIECES, k=length)) for length in lengths]
    for path in [*PATHS, *made]:
        answer = fetch(running, path)
        yield any(secret in answer.body for secret in SECRETS), answer.status


def requests(draw: random.Random, number: int) -> Iterator[bytes]:
    """Requests that are huge, half, badly chunked, or nothing at all."""
    start = b"GET / HTTP/1.1\r\nHost: 127.0.0.1\r\n"
    yield from (CHUNKED + chunk for chunk in BAD_CHUNKS)
    yield from HALVES
    yield b"GET /" + b"a" * 1_000_000 + b" HTTP/1.1\r\n\r\n"
    yield start + b"X: " + b"a" * 1_000_000 + b"\r\n\r\n"
    yield start + b"".join(b"X%d: 1\r\n" % k for k in range(20_000)) + b"\r\n"
    yield start + b"Content-Length: 99999999999999999999\r\n\r\n"
    yield start + b"Content-Length: -1\r\n\r\n"
    yield start + b"Content-Length: 5\r\nTransfer-Encoding: chunked\r\n\r\n0\r\n\r\n"
    yield CHUNKED + b"ffffffffffffffff\r\nabc"
    whole = start + b"Upgrade: websocket\r\nConnection: Upgrade\r\n\r\n"
    for _ in range(number):
        spoilt = bytearray(whole)
        for _ in range(draw.randrange(1, 6)):
            spoilt[draw.randrange(len(spoilt))] = draw.randrange(256)
        yield bytes(spoilt[: draw.randrange(1, len(spoilt) + 1)])
        yield draw.randbytes(draw.randrange(1, 400))


def status_of(running: Running, request: bytes) -> int:
    """Status of the answer to bytes on a connection; 0 for none."""
    with suppress(OSError), raw(running, request) as there:
        there.shutdown(socket.SHUT_WR)
        there.settimeout(5.0)
        words = there.recv(1000).split()
        return int(words[1]) if len(words) > 1 and words[1].isdigit() else 0
    return 0


def vandals(running: Running, number: int) -> Iterator[tuple[bool, int]]:
    """Requests that are none; it counts as let in if the server answers no more."""
    for request in requests(random.Random(SEED), number):
        status = status_of(running, request)
        yield fetch(running, "/").status != 200, status


def talkers(
    running: Running, session: FakeSession, number: int
) -> Iterator[tuple[bool, int]]:
    """Messages of a driver's page that are none, or for the experimenter alone."""
    draw = random.Random(SEED)
    forbidden = ['{"type":"restart"}', '{"type":"stop"}']
    forbidden += ['{"type":"set","name":"mass","value":1}']
    forbidden += ['{"type":"stop","role":"experimenter"}', '[{"type":"stop"}]']
    for _ in range(number):
        spoilt = draw.choice(forbidden)
        place = draw.randrange(len(spoilt))
        said = draw.choice(
            (spoilt, spoilt[:place], "[" * 900, "x" * 100_000, draw.randbytes(50))
        )
        session.applied.clear()
        with suppress(WebSocketException, OSError), socket_of(running) as there:
            there.recv(5.0)
            there.send(said)
            there.recv(5.0)
        yield any(isinstance(m, EXPERIMENTER_ONLY) for _, m in session.applied), 0


def spoilt_record(text: str) -> TrialRecord:
    """A record whose every word is this text."""
    sound = synthetic_record("weak-normal", length=300.0)
    about = {name: text for name, value in sound.metadata.items() if value is not None}
    marker = {"time": 1.0, "kind": text, "name": text, "unit": text, "note": text}
    return TrialRecord(about | {"markers": [marker]}, sound.columns)


def may_run(answer: Answer, text: str) -> bool:
    """Whether a browser could run a text that it was sent."""
    policy = answer.headers["Content-Security-Policy"] or ""
    is_bound = "default-src 'self'" in policy and "script-src" not in policy
    is_page = "html" in (answer.headers["Content-Type"] or "html")
    is_guessed = answer.headers["X-Content-Type-Options"] != "nosniff"
    return not is_bound or (text.encode() in answer.body and (is_page or is_guessed))


def shown(folder: Path) -> Iterator[tuple[bool, int]]:
    """HTML in a replayed record: nothing may be sent as a page, or made one of."""
    scripts = [s for s in static_folder().rglob("*.js") if "vendor" not in s.parts]
    assert scripts
    for script in scripts:
        yield any(each in script.read_text("utf-8") for each in WRITERS), 0
    for text in EVIL_HTML:
        record = spoilt_record(text)
        app = partial(replay_app, replay_of(record, text), folder=folder)
        with served(app) as there:
            for path in ("/", "/api/hello", "/api/record"):
                answer = fetch(there, path)
                yield may_run(answer, text), answer.status
        made = table(record.metadata, record.columns)
        yield "<img" in made or "<script" in made, 0


def cells(folder: Path) -> Iterator[tuple[bool, int]]:
    """Formulas in texts of other people, in the tables that costeer writes."""
    for text in FORMULAS:
        write_csv(folder / "study.csv", [{"participant": text, "condition": text}])
        write_rows(folder / "analysed.csv", [], {text: text})
        for name in ("study.csv", "analysed.csv"):
            written = io.StringIO((folder / name).read_bytes().decode(), newline="")
            _, *rows = csv.reader(written)
            for cell in (cell for row in rows for cell in row if cell):
                yield cell[0] in "=+-@\t\r\n", 0


def attacked(number: int) -> list[Tally]:
    """Every sort of attack."""
    session = FakeSession()
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        static = page_files(folder)

        def app(access: Access) -> object:
            return drive_app(session, access, static)

        with served(app) as open_one, served(app, GUARDED) as guarded:  # type: ignore[arg-type]  # the fake has what is asked of a session
            assert opens(open_one, origin=own_origin(open_one)), "nobody gets in at all"
            assert opens(guarded, f"?token={TOKEN}"), "nobody gets in at all"
            return [
                counted("foreign names and origins", foreigners(open_one)),
                counted("no token, nearly right tokens", strangers(guarded, number)),
                counted("paths out of the folder", climbers(open_one, number)),
                counted("bad requests", vandals(open_one, number)),
                counted("messages", talkers(open_one, session, number)),
                counted("HTML in records", shown(static)),
                counted("formulas in tables", cells(folder)),
            ]


def main() -> int:
    """Print what became of the attacks; return the exit code."""
    number = int(sys.argv[1]) if len(sys.argv) > 1 else 200
    with Told() as told:
        tallies = attacked(number)
    tallies.append(Tally("all", *(sum(each[k] for each in tallies) for k in (1, 2, 3))))
    for name, tried, let_in, errors in tallies:
        print(f"{name}: {tried:,} tried, {let_in} let in, {errors} answers of 500")
    print(f"{len(told.tracebacks)} tracebacks")
    print(*told.tracebacks[:3], sep="\n")
    return int(any(tallies[-1][2:]) or bool(told.tracebacks))


if __name__ == "__main__":
    sys.exit(main())
