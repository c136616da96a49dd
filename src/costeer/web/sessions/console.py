"""What the experimenter sees of a session, and what the experimenter can do."""

from __future__ import annotations

import os
import shutil
import threading
import time
from collections.abc import Callable, Mapping
from contextlib import nullcontext
from datetime import datetime
from typing import Any

from costeer.sessions.balance import balance
from costeer.sessions.plan import Plan, PlanStep
from costeer.sessions.plan_words import check_words
from costeer.sessions.questionnaires.texts import languages
from costeer.sessions.standing import HOLDING, known_person
from costeer.sessions.stopping import take_part_again
from costeer.sessions.store import now
from costeer.sessions.wellbeing import held, let_go_on
from costeer.sessions.withdrawal import num_withdrawn, withdraw
from costeer.web.sessions.desk import Desk
from costeer.web.sessions.step_drive import PAUSED, RUNNING, SAVING

# Any, in this file: of JSON.
SCARCE = 2_000_000_000
"""Less free space is told on the console [bytes]: some fifty trials."""

_SHOWN = ("sdlp", "swrr", "driver_torque_rms", "num_lane_changes", "mean_speed")
"""Measures that stand in the console's list of trials."""


class Console:
    """The experimenter's side of a desk.

    Args:
        desk: Of the session.
    """

    def __init__(self, desk: Desk) -> None:
        self._desk, self._session = desk, desk.session
        self._checking = threading.Lock()
        self._kept: tuple[tuple[int, str], dict[str, Any]] = (-1, ""), {}

    def shown(self) -> dict[str, Any]:
        """Everything the console shows."""
        with self._desk.lock:
            state = self._desk.state()
            step = state["step"]
            if step is not None:
                step.pop("instrument", None)
            free = shutil.disk_usage(self._session.folder).free
            return {
                "type": "console",
                "title": state["title"],
                "now": now().utc,
                "zone": datetime.now().astimezone().tzname(),
                "participant": state["participant"],
                "step": step,
                **self._of_store(),
                "languages": languages(self._session.folder),
                "language": self._session.plan.language,
                "planned": self._session.plan.participants,
                "checks": self._desk.checked,
                "page_seen": time.monotonic() - self._desk.page_seen,
                "pictures": self._desk.pictures,
                "disk": {"free": free, "enough": free > SCARCE},
                "processes": self._processes(),
                "trouble": self._desk.trouble,
                "wording": self._desk.wording.trouble,
                "stopped": state["stopped"],
            }

    def _of_store(self) -> dict[str, Any]:
        """What follows from the store alone, kept as long as nothing is written.

        The console asks twice a second, in the middle of drives.
        """
        key = self._session.store.changes, self._desk.participant
        if self._kept[0] != key:
            told = {
                "steps": self._all_steps(),
                "people": self._people(),
                "withdrawn": num_withdrawn(self._session),
                "attempts": self._attempts(),
                "balance": self._balance(),
                "events": self._events(),
                "unwell": held(self._session, self._desk.participant),
            }
            self._kept = key, told
        return self._kept[1]

    def _all_steps(self) -> list[dict[str, Any]]:
        if not self._desk.participant:
            return []
        over = self._session.over(self._desk.participant)
        return [
            {
                "id": each.id,
                "kind": each.kind,
                "condition": each.condition,
                "state": over.get(each.id, {}).get("state", ""),
            }
            for each in self._session.steps_of(self._desk.participant)
        ]

    def _people(self) -> list[dict[str, Any]]:
        over: dict[str, set[str]] = {}
        for row in self._session.store.rows("SELECT participant, step FROM steps"):
            over.setdefault(row["participant"], set()).add(row["step"])
        told = []
        for row in self._session.people():
            steps = self._session.steps_of(row["participant"])
            done = over.get(row["participant"], set())
            last = len(steps) - 1
            place = next((n for n, e in enumerate(steps) if e.id not in done), last)
            names = ("participant", "slot", "status", "reason")
            about = {"step": steps[place].id, "number": place + 1, "of": last}
            told.append({name: row[name] for name in names} | about)
        return told

    def _attempts(self) -> list[dict[str, Any]]:
        if not self._desk.participant:
            return []
        names = ("step", "attempt", "kind", "condition", "order", "state", "reason")
        return [
            {name: row[name] for name in (*names, "excluded", "started", "ended")}
            | {"measures": {n: row["measures"].get(n) for n in _SHOWN}}
            for row in self._desk.attempts.listed(self._desk.participant)
        ]

    def _processes(self) -> dict[str, int]:
        """Numbers of the processes that run, for who looks into trouble."""
        drive = self._desk.drive
        told = {} if drive is None or drive.pages is None else drive.pages.drive.pids
        return {"server": os.getpid(), **told}

    def _balance(self) -> dict[str, Any]:
        """How even the orders of those are who drive the blocks of the plan of now."""
        blocks = _blocks(self._session.plan)
        slots = [
            int(row["slot"])
            for row in self._session.people()
            if row["status"] in HOLDING
            and _blocks(self._session.plan_of(row["participant"])) == blocks
        ]
        found = balance(self._session.plan, slots)
        return {"places": found.places, "even": found.is_even and bool(slots)}

    def _events(self) -> list[dict[str, Any]]:
        return self._session.store.rows(
            "SELECT utc, kind, step, text FROM events WHERE participant = ? "
            "ORDER BY number DESC LIMIT 30",
            self._desk.participant,
        )

    def act(self, action: str, given: Mapping[str, Any]) -> dict[str, Any]:
        """Do what the console wants.

        Raises:
            ValueError: If there is no such action, or it cannot be done now.
            OSError: If it cannot be kept.
        """
        wanted = ACTIONS.get(action)
        if wanted is None:
            raise ValueError(f"there is no '{action}'; {', '.join(ACTIONS)} are known")
        function, names = wanted
        missing = [name for name in names if name not in given]
        if missing:
            raise ValueError(f"{action} needs {', '.join(missing)}")
        more = [given[name] for name in _OPTIONAL.get(action, ()) if name in given]
        # What stops a drive waits for nobody, and looking at devices makes nobody wait.
        lock = nullcontext() if action in _AT_ONCE else self._desk.lock
        with lock:
            function(self, *(given[name] for name in names), *more)
        return self.shown()

    def begin(self, participant: str, language: str = "") -> None:
        """Let a participant sit down."""
        told = str(participant).strip()
        known = languages(self._session.folder)
        if language and language not in known:
            raise ValueError(
                f"language '{language}' is not known; choose one of {', '.join(known)}"
            )
        if self._desk.participant and self._desk.participant != told:
            self._refuse_while_driving()
            self._desk.leave_drive("another participant sat down")
        row = known_person(told, self._session.people())
        if row is None:
            check_words(self._session.plan, self._session.folder, str(language))
        else:
            plan = self._session.plan_of(told)
            check_words(plan, self._session.folder, row["language"])
        self._session.begin(told, str(language))
        take_part_again(self._session, told)
        self._desk.participant = told
        self._desk.trouble = ""

    def leave(self) -> None:
        """Let the participant go; they may go on later."""
        self._refuse_while_driving()
        self._desk.leave_drive("the participant left")
        self._desk.participant = ""

    def _refuse_while_driving(self) -> None:
        drive = self._desk.drive
        if drive is not None and drive.state in (RUNNING, PAUSED, SAVING):
            raise ValueError("a drive is on; stop it first")

    def _command(self, *command: object) -> None:
        if self._desk.drive is None or not self._desk.present().step.drives:
            raise ValueError("nobody drives in this step")
        if not self._desk.drive_on_show:
            raise ValueError("no drive may begin now; the console says why")
        self._desk.drive.ask(*map(str, command))

    def retry(self) -> None:
        """Try again what could not be done."""
        self._desk.trouble = ""

    def well(self, reason: str) -> None:
        """Let the participant go on, whatever a questionnaire says."""
        let_go_on(self._session, self._desk.present().participant, str(reason))

    def stop(self, reason: str = "stopped by the experimenter") -> None:
        """End the attempt; it is kept as aborted and driven again."""
        drive = self._desk.drive
        if drive is None:
            raise ValueError("nobody drives in this step")
        drive.end(False, reason)

    def enough(self) -> None:
        """Practice is enough, whatever clock and criterion say."""
        standing = self._desk.present()
        if standing.step.kind != "practise" or self._desk.drive is None:
            raise ValueError("no practice is on")
        self._desk.drive.end(True, "ended by the experimenter", True)

    def skip(self, step: str, reason: str) -> None:
        """Leave the step out."""
        standing = self._desk.present()
        is_driven = standing.step.drives
        if is_driven:
            self._refuse_while_driving()
        self._session.skip(standing.participant, str(step), str(reason))
        if is_driven:  # else the drive that is ready is for a later step
            self._desk.leave_drive("the step was skipped")

    def repeat(self, step: str, reason: str) -> None:
        """Have a step done again."""
        self._refuse_while_driving()
        standing = self._desk.present()
        self._session.repeat(standing.participant, str(step), str(reason))

    def exclude(self, step: str, attempt: object, reason: str, out: bool) -> None:
        """Leave a drive out of the analysis, or take it in."""
        who = self._desk.present().participant
        number = int(str(attempt))
        self._desk.attempts.exclude(who, str(step), number, str(reason), out)

    def note(self, text: str) -> None:
        """Keep a note."""
        self._session.note(self._desk.participant, str(text))

    def withdraw(self, participant: str, confirm: str) -> None:
        """Delete everything of a participant who asks for it."""
        who = str(participant)
        if confirm != who:
            raise ValueError("type the pseudonym again to delete everything of it")
        if who == self._desk.participant:
            self.leave()
            if not self._desk.wait_until_idle():
                raise ValueError("the last drive is being saved; try again in a moment")
        withdraw(self._session, who)

    def replace(self, participant: str, reason: str) -> None:
        """Count a participant out, whose row of the orders is free for the next."""
        who = str(participant)
        if who == self._desk.participant:
            self.leave()
        self._session.drop(who, str(reason))

    def check(self) -> None:
        """Look at the devices."""
        with self._checking:
            found = [
                {"name": name, "well": well, "told": told, "utc": now().utc}
                for name, well, told in self._desk.devices.checks()
            ]
        with self._desk.lock, self._session.store.transaction():
            self._desk.checked = found
            self._session.store.tell(
                "checked",
                participant=self._desk.participant,
                data={"checks": self._desk.checked},
            )


def _blocks(plan: Plan) -> list[PlanStep]:
    """What decides the orders: the blocks of trials."""
    return [each for each in plan.steps if each.kind == "trials"]


ACTIONS: dict[str, tuple[Callable[..., None], tuple[str, ...]]] = {
    "begin": (Console.begin, ("participant",)),
    "leave": (Console.leave, ()),
    "retry": (Console.retry, ()),
    "well": (Console.well, ("reason",)),
    "start": (lambda console: console._command("start"), ()),
    "pause": (lambda console: console._command("pause", "experimenter"), ()),
    "resume": (lambda console: console._command("resume"), ()),
    "acknowledge": (lambda console: console._command("acknowledge"), ()),
    "stop": (Console.stop, ()),
    "emergency": (lambda console: console.stop("emergency stop"), ()),
    "finish": (Console.enough, ()),
    "skip": (Console.skip, ("step", "reason")),
    "repeat": (Console.repeat, ("step", "reason")),
    "exclude": (
        lambda console, *given: console.exclude(*given, True),
        ("step", "attempt", "reason"),
    ),
    "include": (
        lambda console, *given: console.exclude(*given, False),
        ("step", "attempt", "reason"),
    ),
    "note": (Console.note, ("text",)),
    "replace": (Console.replace, ("participant", "reason")),
    "withdraw": (Console.withdraw, ("participant", "confirm")),
    "check": (Console.check, ()),
}
"""What the console can ask for, and what it has to say with it."""

_AT_ONCE = ("emergency", "stop", "pause", "check")
"""What does not wait until others have been answered."""

_OPTIONAL = {"begin": ("language",)}
"""What may be said with an action besides."""
