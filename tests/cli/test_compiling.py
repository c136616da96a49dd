"""Who waits for machine code reads what it is for, and how much may follow."""

from __future__ import annotations

import threading

import pytest

from costeer.cli import compiling


def told(monkeypatch: pytest.MonkeyPatch, prepare: bool) -> list[str]:
    """The lines of a compilation that lasts past the first of them."""
    monkeypatch.setattr(compiling, "_PATIENCE", 0.0)
    said: list[str] = []
    begun, ended = threading.Event(), threading.Event()

    def note(line: str, at_once: bool) -> None:
        said.append(line)
        (ended if "compiled in" in line else begun).set()

    monkeypatch.setattr(compiling, "note", note)

    def work() -> None:
        if prepare:
            compiling.compiled_for("method traded", 3)
        done = compiling._begun()
        assert begun.wait(60.0)
        done()
        assert ended.wait(60.0)

    thread = threading.Thread(target=work)
    thread.start()
    thread.join()
    return said


def test_a_method_is_named_with_what_may_follow(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    first = told(monkeypatch, prepare=True)[0]
    assert first.startswith("costeer: compiling method traded once, about ")
    assert first.endswith("; at most 3 more to compile")


def test_nothing_is_named_that_nobody_told(monkeypatch: pytest.MonkeyPatch) -> None:
    first = told(monkeypatch, prepare=False)[0]
    assert first.startswith("costeer: compiling once, about ")
    assert first.endswith("; later starts find it done")
