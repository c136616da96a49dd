"""A study in its folder: who takes part, what comes next, what was said and driven.

The state is what the store holds. Nothing is changed without being written first, so
that a process that dies at any moment is followed by one that goes on from there.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from costeer.base.files import read_whole
from costeer.loop.scenario import TrialSetup
from costeer.sessions.plan import (
    DONE,
    Plan,
    Step,
    session_steps,
    trial_of,
)
from costeer.sessions.plan_file import LARGEST, parsed_plan, plan_file_in
from costeer.sessions.questionnaires.answers import cleaned
from costeer.sessions.scenarios import scenario_texts
from costeer.sessions.standing import (
    ACTIVE,
    DROPPED,
    FINISHED,
    HOLDING,
    WHOLE,
    OutOfStepError,
    Standing,
    known_person,
    told_reason,
)
from costeer.sessions.store import STORE_FILE, Row, Store, now, refuse_lost_store
from costeer.sessions.versions import PlanVersions

# Any, in this file: values of answers, facts and measures.


class Session:
    """A study with people.

    Args:
        folder: Of the study.

    Raises:
        ValueError: If there is no plan, or it cannot be.
        OSError: If a file cannot be read or written.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        plan_file = plan_file_in(folder)
        text = read_whole(plan_file, LARGEST)
        self.plan = parsed_plan(text, str(plan_file))
        scenarios = scenario_texts(self.plan, folder)
        refuse_lost_store(folder)
        self.store = Store(folder / STORE_FILE)
        self.versions = PlanVersions(self.store)
        self._steps: dict[str, tuple[Step, ...]] = {}
        told = text.decode("utf-8")
        self.plan_version = self.versions.known(self.plan, told, scenarios)

    def forget(self, participant: str) -> None:
        """Delete every row of a participant.

        Raises:
            StoreError: If that cannot be done.
        """
        self.store.forget(participant)
        self._steps.pop(participant, None)

    def close(self) -> None:
        """Close the store."""
        self.store.close()

    # Plans

    def plan_of(self, participant: str) -> Plan:
        """The plan that a participant began with."""
        return self.versions.plan(int(self.person(participant)["plan"]))

    def trial_of(self, participant: str, step: Step) -> TrialSetup:
        """The trial that a participant drives in a step, as their plan has it."""
        row = self.person(participant)
        version = int(row["plan"])
        scenario = self.versions.scenario(version, step.scenario)
        return trial_of(self.versions.plan(version), step, int(row["slot"]), scenario)

    def steps_of(self, participant: str) -> tuple[Step, ...]:
        """All steps of a participant."""
        if participant not in self._steps:
            slot = int(self.person(participant)["slot"])
            self._steps[participant] = session_steps(self.plan_of(participant), slot)
        return self._steps[participant]

    # People

    def people(self) -> list[Row]:
        """Participants in the order in which they came."""
        return self.store.rows("SELECT * FROM participants ORDER BY rowid")

    def person(self, participant: str) -> Row:
        """A participant.

        Raises:
            ValueError: If there is none.
        """
        found = self.store.rows(
            "SELECT * FROM participants WHERE participant = ?", participant
        )
        if not found:
            raise ValueError(
                f"there is no participant '{participant}'; costeer session status "
                f"{self.folder} lists them"
            )
        return found[0]

    def free_slot(self) -> int:
        """The first slot that nobody holds: a dropout's before a new one."""
        held = {int(row["slot"]) for row in self.people() if row["status"] in HOLDING}
        return next(slot for slot in range(1, len(held) + 2) if slot not in held)

    def begin(self, participant: str, language: str = "") -> Standing:
        """Let a participant take part, or go on where they stopped.

        Args:
            participant: Pseudonym.
            language: Of the texts; the plan's if empty.

        Raises:
            ValueError: If it is no pseudonym, or who bears it has ended.
            StoreError: If it cannot be written.
        """
        known = known_person(participant, self.people())
        with self.store.transaction():
            if known is None:
                self.store.put(
                    "participants",
                    {
                        "participant": participant,
                        "slot": self.free_slot(),
                        "plan": self.plan_version,
                        "language": language or self.plan.language,
                        "status": ACTIVE,
                        **now()._asdict(),
                    },
                )
            self.store.tell("resumed" if known else "began", participant=participant)
        return self.standing(participant)

    def language_of(self, participant: str) -> str:
        """Language of a participant's texts."""
        return str(self.person(participant)["language"])

    def drop(self, participant: str, reason: str) -> None:
        """Count a participant out; the data stay, the slot is free for another.

        Raises:
            ValueError: If there is none, or no reason.
            StoreError: If it cannot be written.
        """
        told = told_reason(reason)
        with self.store.transaction():
            self.set_status(participant, DROPPED, told)
            self.store.tell("dropped", told, participant)

    def set_status(
        self, participant: str, status: str, reason: str = "", slot: int = 0
    ) -> None:
        """Write how it stands with somebody, within a transaction; slot 0: the same."""
        changed = {"status": status, "reason": reason} | (
            {"slot": slot} if slot else {}
        )
        self.store.put("participants", self.person(participant) | changed)
        self._steps.pop(participant, None)

    def status_of(self, participant: str) -> str:
        """How it stands with a participant.

        Raises:
            ValueError: If there is none.
        """
        return str(self.person(participant)["status"])

    # Steps

    def over(self, participant: str) -> dict[str, Row]:
        """Steps that are finished or skipped."""
        rows = self.store.rows("SELECT * FROM steps WHERE participant = ?", participant)
        return {row["step"]: row for row in rows}

    def standing(self, participant: str) -> Standing:
        """Where a participant stands: at the first step that is not over.

        Raises:
            ValueError: If there is none.
        """
        steps, over = self.steps_of(participant), self.over(participant)
        place = next(
            (n for n, each in enumerate(steps) if each.id not in over), len(steps) - 1
        )
        step = steps[place]
        attempts = self.store.rows(
            "SELECT * FROM attempts WHERE participant = ? AND step = ? "
            "ORDER BY attempt",
            *(participant, step.id),
        )
        return Standing(participant, step, place + 1, len(steps) - 1, tuple(attempts))

    def on(self, participant: str, step: str) -> Step:
        """The step that is on, if it is that one.

        Raises:
            OutOfStepError: If another is on.
        """
        on = self.standing(participant).step
        if step == DONE.id:
            raise OutOfStepError("the session is over; nothing is left to do")
        if on.id != step:
            raise OutOfStepError(
                f"step '{step}' is not on; {participant} stands at '{on.id}'"
            )
        return on

    def finish(self, participant: str, step: str, reason: str = "") -> None:
        """Take a step as done; one that is done already stays so.

        Raises:
            OutOfStepError: If another is on.
            StoreError: If it cannot be written.
        """
        if self.over(participant).get(step, {}).get("state") == "finished":
            return
        self.on(participant, step)
        with self.store.transaction():
            self.set_over(participant, step, "finished", reason)

    def skip(self, participant: str, step: str, reason: str) -> None:
        """Leave a step out, for a reason.

        Raises:
            OutOfStepError: If another is on.
            ValueError: If there is no reason.
            StoreError: If it cannot be written.
        """
        self.on(participant, step)
        with self.store.transaction():
            self.set_over(participant, step, "skipped", told_reason(reason))

    def set_over(self, participant: str, step: str, state: str, reason: str) -> None:
        """Write that a step is over, within a transaction."""
        self.store.put(
            "steps",
            {
                "participant": participant,
                "step": step,
                "state": state,
                "reason": reason,
                **now()._asdict(),
            },
        )
        self.store.tell(f"step {state}", reason, participant, step)
        ids = [each.id for each in self.steps_of(participant)]
        done = {step, *self.over(participant)}
        is_active = self.status_of(participant) == ACTIVE
        if is_active and all(each in done for each in ids if each != DONE.id):
            self.set_status(participant, FINISHED)
            self.store.tell("finished", participant=participant)

    def repeat(self, participant: str, step: str, reason: str) -> None:
        """Have a step done again that is over; what it left stays, attempts excluded.

        Raises:
            ValueError: If there is none of that name, or no reason.
            StoreError: If it cannot be written.
        """
        told = told_reason(reason)
        known = {each.id: each for each in self.steps_of(participant)}
        if step not in known or step == DONE.id:
            raise ValueError(f"{participant} has no step '{step}'")
        if step not in self.over(participant):
            raise OutOfStepError(f"step '{step}' is not over; it cannot be repeated")
        before = self.answers_of(participant, step)
        with self.store.transaction():
            self.store.run(
                "DELETE FROM steps WHERE participant = ? AND step = ?",
                *(participant, step),
            )
            self.store.run(
                "UPDATE attempts SET excluded = 1, reason = ? WHERE participant = ? "
                "AND step = ? AND state = ?",
                *(told, participant, step, WHOLE),
            )
            self.store.run(
                "DELETE FROM answers WHERE participant = ? AND step = ?",
                *(participant, step),
            )
            if self.status_of(participant) == FINISHED:
                self.set_status(participant, ACTIVE)
            answered = {"answers": before} if before else {}
            self.store.tell("repeat", told, participant, step, answered)

    # Answers

    def answer(
        self,
        participant: str,
        step: str,
        answers: Mapping[str, Any],
        instrument: tuple[str, str],
        unwell: str = "",
    ) -> None:
        """Keep the answers of a step and go on.

        Args:
            participant: Who answers.
            step: That they are for.
            answers: Item to value, checked before.
            instrument: Name and version.
            unwell: Why who answers so should not go on.

        Raises:
            OutOfStepError: If another step is on, or other answers were given.
            StoreError: If they cannot be written.
        """
        if step in self.over(participant):
            if self.answers_of(participant, step) == _texts(answers):
                return  # sent twice
            raise OutOfStepError(f"step '{step}' was answered before")
        on = self.on(participant, step)
        moment, language = now()._asdict(), self.language_of(participant)
        with self.store.transaction():
            for item, value in _texts(answers).items():
                self.store.put(
                    "answers",
                    {
                        "participant": participant,
                        "step": step,
                        "condition": on.condition,
                        "instrument": instrument[0],
                        "version": instrument[1],
                        "language": language,
                        "item": item,
                        "value": value,
                        **moment,
                    },
                )
            if unwell:
                self.store.tell("unwell", unwell, participant, step)
            self.set_over(participant, step, "finished", "")

    def answers_of(self, participant: str, step: str) -> dict[str, str]:
        """What was answered at a step, each value as JSON."""
        rows = self.store.rows(
            "SELECT item, value FROM answers WHERE participant = ? AND step = ?",
            *(participant, step),
        )
        return {row["item"]: row["value"] for row in rows}

    # The log

    def note(self, participant: str, text: str) -> None:
        """Keep a note of the experimenter.

        Raises:
            ValueError: If it is empty or too long.
            StoreError: If it cannot be written.
        """
        told = cleaned(text)
        if not 0 < len(told) <= 2000:
            raise ValueError("a note has 1 to 2,000 characters")
        step = self.standing(participant).step.id if participant else ""
        with self.store.transaction():
            self.store.tell("note", told, participant, step)


def _texts(answers: Mapping[str, Any]) -> dict[str, str]:
    """Each value as JSON: numbers and texts stay apart."""
    return {
        item: json.dumps(value, ensure_ascii=False) for item, value in answers.items()
    }
