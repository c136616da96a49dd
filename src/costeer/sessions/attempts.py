"""Attempts at drives: begun, whole or aborted, left out for a reason, never lost."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from itertools import count
from pathlib import Path
from typing import Any

from costeer.sessions.plan import Step
from costeer.sessions.session import Session
from costeer.sessions.standing import WHOLE, told_reason
from costeer.sessions.store import Row, Store, now

# Any, in this file: facts and measures.
RUNNING, ABORTED = "running", "aborted"
"""How it stands with an attempt that is not whole."""


Judge = Callable[[Path, Step], dict[str, Any] | None]
"""Measures of a record if it holds a step from its start to its end, else None."""


def _nothing(record: Path, step: Step) -> None:
    """Nobody judges."""


class Attempts:
    """The drives of a study.

    Args:
        session: Of the study. What a dead process left open is aborted, unless its
            record turns out to be whole.
        judge: Tells whether a record is whole.

    Raises:
        StoreError: If that cannot be written.
    """

    def __init__(self, session: Session, judge: Judge = _nothing) -> None:
        self._session = session
        self._store = session.store
        self._close_left_open(judge)

    def next(self, participant: str, step: Step) -> tuple[int, Path]:
        """Number and record of the next attempt at a step; nothing is written.

        Raises:
            StoreError: If the store cannot be read.
        """
        rows = self._store.rows(
            "SELECT coalesce(max(attempt), 0) AS n FROM attempts "
            "WHERE participant = ? AND step = ?",
            *(participant, step.id),
        )
        room = "records" if step.kind == "drive" else "practice"
        folder = self._session.folder / room
        folder.mkdir(exist_ok=True)
        for attempt in count(int(rows[0]["n"]) + 1):
            suffix = f"-{attempt}" if attempt > 1 else ""
            record = folder / f"{participant}-{step.id}{suffix}.parquet"
            if not record.exists():  # one of another computer is not written over
                break
        return attempt, record

    def start(
        self, participant: str, step: str, facts: Mapping[str, Any]
    ) -> tuple[int, Path]:
        """Begin to drive a step.

        Args:
            participant: Who drives.
            step: That is on.
            facts: Of devices, calibration, versions.

        Returns:
            Number of the attempt, and the record to write.

        Raises:
            OutOfStepError: If another step is on.
            StoreError: If it cannot be written.
        """
        on = self._session.on(participant, step)
        attempt, record = self.next(participant, on)
        moment = now()
        with self._store.transaction():
            self._store.put(
                "attempts",
                {
                    "participant": participant,
                    "step": step,
                    "attempt": attempt,
                    "kind": on.kind,
                    "condition": on.condition,
                    "order": on.order,
                    "state": RUNNING,
                    "record": f"{record.parent.name}/{record.name}",
                    "facts": dict(facts),
                    "started": moment.utc,
                    "monotonic": moment.monotonic,
                },
            )
            self._store.tell(
                "attempt", f"attempt {attempt}", participant, step, dict(facts)
            )
        return attempt, record

    def end(
        self,
        participant: str,
        step: str,
        attempt: int,
        measures: Mapping[str, Any] | None,
        reason: str = "",
        latency: Sequence[str] = (),
    ) -> None:
        """End a drive: whole with its measures, or aborted for a reason.

        A whole one ends its step; an aborted one is driven again.

        Args:
            participant: Who drove.
            step: That was driven.
            attempt: Its number.
            measures: Of a drive that is whole; None if it was aborted.
            reason: Why it was aborted, or what to know of it.
            latency: From device to page, in words.

        Raises:
            StoreError: If it cannot be written.
        """
        (row,) = self._store.rows(
            "SELECT * FROM attempts WHERE participant = ? AND step = ? AND attempt = ?",
            *(participant, step, attempt),
        )
        if row["state"] != RUNNING:
            return
        is_whole = measures is not None
        record = row["record"] if is_whole else self._set_aside(row)
        changed = {
            "state": WHOLE if is_whole else ABORTED,
            "record": record,
            "reason": reason,
            "measures": dict(measures or {}),
            "facts": json.loads(row["facts"]) | {"latency": list(latency)},
            "ended": now().utc,
        }
        with self._store.transaction():
            self._store.put("attempts", row | changed)
            told = "finished" if is_whole else "aborted"
            self._store.tell(f"attempt {told}", reason, participant, step)
            if is_whole and step not in self._session.over(participant):
                self._session.set_over(participant, step, "finished", "")

    def _set_aside(self, row: Row) -> str:
        """Move what an aborted drive has left out of the finished ones."""
        record = self._session.folder / row["record"]
        aside = self._session.folder / "aborted"
        stem = record.name.removesuffix(".parquet")
        moved = ""
        for file in sorted(record.parent.glob(f"{stem}.*")):
            aside.mkdir(exist_ok=True)
            target = aside / file.name.replace(stem, f"{stem}-attempt{row['attempt']}")
            with suppress(OSError):
                file.replace(target)
                moved = f"aborted/{target.name}" if file == record else moved
        return moved

    def _close_left_open(self, judge: Judge) -> None:
        """Judge what a dead process left running: whole, or aborted."""
        for row in self._store.rows("SELECT * FROM attempts WHERE state = ?", RUNNING):
            who, record = row["participant"], self._session.folder / row["record"]
            step = next(
                each for each in self._session.steps_of(who) if each.id == row["step"]
            )
            measures = judge(record, step) if record.is_file() else None
            reason = "the session ended while it was driven"
            if measures is not None:
                reason = "the session ended just after it"
            self.end(who, step.id, int(row["attempt"]), measures, reason)

    def exclude(
        self, participant: str, step: str, attempt: int, reason: str, out: bool = True
    ) -> None:
        """Leave a drive out of the analysis, or take it in again; for a reason.

        Raises:
            ValueError: If there is none, or no reason.
            StoreError: If it cannot be written.
        """
        told = told_reason(reason)
        key = (participant, step, attempt)
        found = self._store.rows(
            "SELECT * FROM attempts WHERE participant = ? AND step = ? AND attempt = ?",
            *key,
        )
        if not found:
            raise ValueError(f"{participant} has no attempt {attempt} at '{step}'")
        with self._store.transaction():
            changed = {"excluded": int(out), "reason": told}
            self._store.put("attempts", found[0] | changed)
            self._store.tell("excluded" if out else "included", told, participant, step)

    def listed(self, participant: str = "") -> list[Row]:
        """Drives of a participant, or of all, with what JSON holds read."""
        return listed_attempts(self._store, participant)


def listed_attempts(store: Store, participant: str = "") -> list[Row]:
    """Drives of a participant, or of all, with what JSON holds read.

    Raises:
        StoreError: If the store cannot be read.
    """
    where, given = (
        (" WHERE participant = ?", [participant]) if participant else ("", [])
    )
    rows = store.rows(
        f"SELECT * FROM attempts{where} ORDER BY participant, rowid", *given
    )
    for row in rows:
        row["facts"], row["measures"] = map(json.loads, (row["facts"], row["measures"]))
    return rows
