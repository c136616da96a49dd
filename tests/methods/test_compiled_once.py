"""What is compiled for a method is made once, whoever asks first."""

from __future__ import annotations

import contextlib
import threading
from typing import Any

import pytest

from costeer.methods import interface
from costeer.methods.ibhs import IBHS
from costeer.methods.interface import compiled_once


def test_threads_that_ask_at_once_share_what_is_made(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(interface, "_COMPILED", {})
    together = threading.Barrier(2)
    made: list[object] = []
    got: list[object] = []

    def make(_: Any) -> object:
        with contextlib.suppress(threading.BrokenBarrierError):
            together.wait(0.2)  # the other one must not come
        made.append(object())
        return made[-1]

    threads = [
        threading.Thread(target=lambda: got.append(compiled_once(make, IBHS)))
        for _ in range(2)
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(made) == 1
    assert got == [made[0]] * 2
