"""A whole study rehearsed: simulated participants on the real pages, and accidents.

A browser without a window answers the questionnaires and starts the drives; virtual
drivers' hands hold a simulated wheel, in haste. On the way server, processes of the
drive and browser are killed at random. Afterwards everything that was answered and
every trial that was finished must be there.
"""

from __future__ import annotations

import json
import re
import time
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

from costeer.base.files import write_text
from costeer.scenarios.reading import shipped
from costeer.sessions.attempts import Attempts
from costeer.sessions.balance import balance
from costeer.sessions.plan import PLAN_FILE
from costeer.sessions.plan_file import paper_plan_text, parsed_plan
from costeer.sessions.robot import RehearsalSettings, Robot, digest, playwright
from costeer.sessions.scenarios import is_file_name
from costeer.sessions.session import Session
from costeer.sessions.standing import WHOLE

_RANGES = {"participants": (1, 1000), "haste": (1.0, 100.0), "accidents": (0.0, 60.0)}
"""Of settings that the plan does not judge."""


class Outcome(NamedTuple):
    """What a rehearsal has shown.

    Attributes:
        participants: Who came to the end.
        answers: That were given.
        lost_answers: Of these, not found as given.
        trials: That were finished.
        lost_trials: Of these, not found as they were.
        accidents: How often each thing was killed.
        even: Whether the orders are balanced.
        waits: Of the console for an answer while someone drove [s], smallest first.
        seconds: It took [s].
    """

    participants: int
    answers: int
    lost_answers: int
    trials: int
    lost_trials: int
    accidents: dict[str, int]
    even: bool
    waits: tuple[float, ...]
    seconds: float


def rehearsal_plan(settings: RehearsalSettings) -> str:
    """The paper's plan, with short drives and one leader early in each."""
    text = paper_plan_text()
    for name, value in (
        ("participants", settings.participants),
        ("scenario", f"{settings.scenario}\nlength: {settings.length:g}"),
    ):
        text = re.sub(rf"(?m)^{name}: .*$", f"{name}: {value}", text)
    text = re.sub(r"longest_minutes: [0-9.]+", "longest_minutes: 1", text)
    text = re.sub(r"(?<!longest_)minutes: [0-9.]+", "minutes: 0.002", text)
    if settings.conditions:
        chosen = ", ".join(settings.conditions)
        text = re.sub(r"conditions: \[.*\]", f"conditions: [{chosen}]", text)
    early = "parameters: {traffic.first_event: 100, traffic.num_events: 1}\n"
    return text.replace("steps:\n", f"{early}steps:\n", 1)


def rehearse(
    folder: Path, settings: RehearsalSettings, told: Callable[[str], None] = print
) -> Outcome:
    """Rehearse a study in a folder.

    Args:
        folder: Of the study; it must not hold one.
        settings: What is rehearsed.
        told: Is told how far it is.

    Raises:
        ValueError: If there is a study already, or nothing moves any more.
        ModuleNotFoundError: If Playwright is not installed.
        OSError: If there is no browser.
    """
    if (folder / PLAN_FILE).exists():
        raise ValueError(f"{folder} holds a study already; give a new folder")
    for name, (low, high) in _RANGES.items():
        value = getattr(settings, name)
        if not low <= value <= high:
            raise ValueError(f"{name} is {value:g}; give {low:g} to {high:g}")
    if is_file_name(settings.scenario):
        raise ValueError(
            f"scenario is {settings.scenario}; a rehearsal drives on one of "
            f"{', '.join(shipped())}"
        )
    plan = rehearsal_plan(settings)
    parsed_plan(plan)
    folder.mkdir(parents=True, exist_ok=True)
    write_text(folder / PLAN_FILE, plan)
    begun = time.monotonic()
    with playwright() as library:
        robot = Robot(folder, settings, library, told)
        try:
            for number in range(1, settings.participants + 1):
                robot.take_part(f"R{number:02d}")
        finally:
            robot.close()
    return _judged(folder, robot, time.monotonic() - begun)


def _judged(folder: Path, robot: Robot, seconds: float) -> Outcome:
    """Compare what was done with what is kept."""
    session = Session(folder)
    lost_answers = num_answers = 0
    for (who, step), chosen in robot.given.items():
        kept = session.answers_of(who, step)
        for item, value in chosen.items():
            num_answers += 1
            found = json.loads(kept[item]) if item in kept else None
            lost_answers += found != value
    rows = {
        (row["participant"], row["step"], row["attempt"]): row
        for row in Attempts(session).listed()
    }
    lost_trials = sum(
        rows.get(key, {}).get("state") != WHOLE or digest(folder, *key) != before
        for key, before in robot.finished.items()
    )
    slots = [int(row["slot"]) for row in session.people()]
    outcome = Outcome(
        participants=sum(row["status"] == "finished" for row in session.people()),
        answers=num_answers,
        lost_answers=lost_answers,
        trials=sum(row["state"] == WHOLE for row in rows.values()),
        lost_trials=lost_trials,
        accidents=robot.accidents,
        even=balance(session.plan, slots).is_even,
        waits=tuple(sorted(robot.waits)),
        seconds=seconds,
    )
    session.close()
    return outcome
