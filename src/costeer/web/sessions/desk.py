"""What the server does for a session: the participant's steps and the console's wishes.

Every method may be called from any thread; one lock keeps them apart. What changes the
store has changed it before it returns.
"""

from __future__ import annotations

import hashlib
import math
import threading
import time
from collections.abc import Callable, Mapping
from importlib import metadata as distribution
from typing import Any, NamedTuple

from costeer.devices.head.calibration import HeadCalibration
from costeer.devices.wheels.calibration import WheelCalibration
from costeer.devices.wheels.interface import WheelDescription
from costeer.devices.wheels.simulated import in_hands_of
from costeer.loop.trial import git_revision
from costeer.runtime.setup import DriveSetup, check_drive
from costeer.sessions.attempts import Attempts
from costeer.sessions.plan import Step, trial_of
from costeer.sessions.questionnaires.answers import checked_answers
from costeer.sessions.questionnaires.instrument import (
    Instrument,
    load_instrument,
    rendered,
)
from costeer.sessions.questionnaires.texts import load_texts
from costeer.sessions.session import Session
from costeer.sessions.standing import Standing
from costeer.sessions.store import StoreError
from costeer.web.drive import PageOptions
from costeer.web.sessions.judged import driven_whole, measured
from costeer.web.sessions.step_drive import FAILED, Outcome, StepDrive

# Any, in this file: of JSON.


class Devices(NamedTuple):
    """What participants drive with.

    Attributes:
        input: "keyboard", "gamepad" or "wheel".
        wheel: None for virtual hands.
        calibration: None for virtual hands.
        head: Makes the calibration of a participant's head; None without a tracker.
        checks: Looks at the devices: name, whether it is well, what to do.
        haste: Of rehearsals with virtual hands.
    """

    input: str = "keyboard"
    wheel: WheelDescription | None = None
    calibration: WheelCalibration | None = None
    head: Callable[[str], HeadCalibration | None] = lambda participant: None
    checks: Callable[[], list[tuple[str, bool, str]]] = list
    haste: float = 1.0


class Desk:
    """The session as its pages see it.

    Args:
        session: Of the study.
        devices: Of the lab.
    """

    def __init__(self, session: Session, devices: Devices) -> None:
        self.session, self.devices = session, devices
        self.attempts = Attempts(session, driven_whole)
        self.lock = threading.RLock()
        self._idle = threading.Condition(self.lock)
        self.participant = ""
        self._drive: StepDrive | None = None
        self._driven: tuple[str, str, int] | None = None
        self._is_begun = False
        self._break_began: dict[tuple[str, str], float] = {}
        self.checked: list[dict[str, Any]] = []
        self.trouble = ""
        self.page_seen = -math.inf
        self._is_closing = False

    # What is on

    @property
    def drive(self) -> StepDrive | None:
        """The drive that is on."""
        return self._drive

    @property
    def drive_on_show(self) -> StepDrive | None:
        """The drive of the step that is on; none while one only waits for its step."""
        return self._drive if self._is_begun else None

    def standing(self) -> Standing | None:
        """Where the participant stands; None without one."""
        if not self.participant:
            return None
        return self.session.standing(self.participant)

    def state(self) -> dict[str, Any]:
        """What the participant's page shows."""
        with self.lock:
            standing = self.standing()
            language = self._language()
            told: dict[str, Any] = {
                "type": "session",
                "title": self.session.plan.title,
                "language": language,
                "texts": load_texts(language, self.session.folder).pages,
                "trouble": self.trouble,
            }
            if standing is None:
                return told | {"participant": "", "step": None}
            self._prepare(standing)
            return told | {
                "participant": standing.participant,
                "step": self._shown(standing),
            }

    def _language(self) -> str:
        if not self.participant:
            return self.session.plan.language
        return self.session.language_of(self.participant)

    def _shown(self, standing: Standing) -> dict[str, Any]:
        """A step as the participant's page takes it."""
        step = standing.step
        shown: dict[str, Any] = {
            "id": step.id,
            "kind": step.kind,
            **self._words(step),
            "condition": step.condition,
            "number": standing.number,
            "of": standing.of,
            "minutes": step.minutes,
            "order": step.order,
            "trials": self._num_trials(standing.participant),
            "self_paced": self.session.plan_of(standing.participant).self_paced,
        }
        if step.kind in ("ask", "consent"):
            shown["instrument"] = rendered(
                self._instrument(step), self._seed(standing.participant, step)
            )
        if step.kind == "break":
            shown["remaining"] = self._remaining(standing)
        if step.drives:
            drive = self._drive
            shown["drive"] = {"state": "waiting"} if drive is None else drive.told()
            shown["enough"] = self._is_enough(step)
        return shown

    def _num_trials(self, participant: str) -> int:
        steps = self.session.steps_of(participant)
        return sum(each.kind == "drive" for each in steps)

    def _words(self, step: Step) -> dict[str, str]:
        """Heading and text of a step: of the text files, or the plan's own."""
        pages = load_texts(self._language(), self.session.folder).pages
        text = pages.get(f"{step.text}_text", step.text)
        return {"title": pages.get(f"{step.text}_title", ""), "text": text}

    def _instrument(self, step: Step) -> Instrument:
        return load_instrument(step.instrument, self._language(), self.session.folder)

    def _seed(self, participant: str, step: Step) -> int:
        """Of a questionnaire's random order: the same after a reload."""
        told = f"{self.session.plan.seed} {participant} {step.id}"
        return int.from_bytes(hashlib.sha256(told.encode()).digest()[:7])

    def _remaining(self, standing: Standing) -> float:
        """Of a break [s]."""
        key = standing.participant, standing.step.id
        began = self._break_began.setdefault(key, time.monotonic())
        return max(0.0, round(60.0 * standing.step.minutes - time.monotonic() + began))

    def _is_enough(self, step: Step) -> bool:
        """Whether a practice was long enough."""
        seconds = 0.0 if self._drive is None else self._drive.seconds
        return step.kind == "practise" and seconds >= 60.0 * step.minutes

    # What participants do

    def next(self, step: str) -> dict[str, Any]:
        """Go on from a step that needs nothing else, or from practice.

        Raises:
            ValueError: If it is not that far.
            OSError: If it cannot be kept.
        """
        with self.lock:
            standing = self.present()
            if step not in self.session.over(standing.participant):
                on = self.session.on(standing.participant, step)
                self._go_on(standing, on)
            return self.state()

    def _go_on(self, standing: Standing, on: Step) -> None:
        """End a step that its page ends.

        Raises:
            ValueError: If the step does not end so.
        """
        if on.kind in ("ask", "consent"):
            raise ValueError("the questions come first")
        if on.kind == "drive":
            raise ValueError("the trial ends at the end of the course")
        if on.kind == "break" and self._remaining(standing) > 0.0:
            raise ValueError("the break is not over yet")
        if on.kind == "practise":
            if not self._is_enough(on):
                raise ValueError(f"practise for at least {on.minutes:g} min")
            self._end_practice()
            return
        self.session.finish(standing.participant, on.id)

    def answers(self, step: str, given: Mapping[str, Any]) -> dict[str, Any]:
        """Take the answers of a step.

        Raises:
            ValueError: If one is missing or cannot be, or another step is on.
            OSError: If they cannot be kept.
        """
        with self.lock:
            standing = self.present()
            who = standing.participant
            steps = {each.id: each for each in self.session.steps_of(who)}
            if step not in steps or steps[step].kind not in ("ask", "consent"):
                raise ValueError(f"step '{step}' asks nothing")
            instrument = self._instrument(steps[step])
            checked = checked_answers(instrument, given)
            about = instrument.name, instrument.version
            self.session.answer(who, step, checked, about)
            return self.state()

    def present(self) -> Standing:
        """Where the participant who is here stands.

        Raises:
            ValueError: If nobody is.
        """
        standing = self.standing()
        if standing is None:
            raise ValueError("no participant is here; the experimenter begins one")
        return standing

    # Drives

    def _prepare(self, standing: Standing) -> None:
        """Have the processes of the drive that is on, or comes next, ready."""
        who, over = standing.participant, self.session.over(standing.participant)
        steps = self.session.steps_of(who)
        ahead = [each for each in steps if each.drives and each.id not in over]
        if self._is_closing or not ahead or self.trouble:
            return
        try:
            if self._driven is not None and self._driven[:2] != (who, ahead[0].id):
                self.leave_drive("another step is on")
            if self._drive is None:
                self._start(who, ahead[0])
            if ahead[0].id == standing.step.id and not self._is_begun:
                self._begin_attempt(who, ahead[0])
        except (ValueError, OSError) as error:
            self.trouble = str(error)

    def _begin_attempt(self, who: str, step: Step) -> None:
        """Write that the drive that is ready is driven.

        Raises:
            StoreError: If it cannot be written.
        """
        if self._drive is not None and self._driven is not None:
            if self._driven[:2] != (who, step.id) or self._drive.is_ending:
                return
            self.attempts.start(who, step.id, self._facts(self._drive.setup))
            self._is_begun = True

    def _start(self, who: str, step: Step) -> None:
        """Start the processes of an attempt.

        Raises:
            ValueError: If the drive cannot be.
            OSError: If nothing can be written.
        """
        plan, slot = self.session.plan_of(who), int(self._row(who)["slot"])
        trial = trial_of(plan, step, slot)
        setup = DriveSetup(
            trial=trial,
            wheel=in_hands_of(self.devices.wheel, slot, step.id, trial.speed),
            calibration=self.devices.calibration,
            intention=plan.intention,
            head=self.devices.head(who),
            participant=who,
            haste=self.devices.haste,
        )
        check_drive(setup)
        number, record = self.attempts.next(who, step)
        self._driven, self._is_begun = (who, step.id, number), False
        options = PageOptions(self.devices.input, False, plan.self_paced)
        self._drive = StepDrive(setup, record, options, self._end)
        self._drive.begin()

    def _facts(self, setup: DriveSetup) -> dict[str, Any]:
        """What a reader of the methods section asks for."""
        calibration = self.devices.calibration
        return {
            "costeer": distribution.version("costeer"),
            "git_revision": git_revision(),
            "input": self.devices.input,
            "wheel": None if setup.wheel is None else setup.wheel.name,
            "wheel_calibration": None if calibration is None else calibration._asdict(),
            "head": None if setup.head is None else setup.head.tracker.kind,
            "checks": self.checked,
        }

    def _row(self, participant: str) -> dict[str, Any]:
        rows = self.session.people()
        return next(row for row in rows if row["participant"] == participant)

    def _end(self, outcome: Outcome) -> None:
        """Keep how an attempt ended; called in a thread of the drive.

        Pages are answered while the record is measured and written.
        """
        with self.lock:
            driven, is_begun = self._driven, self._is_begun
        if driven is None:
            return
        if is_begun:
            self._keep(driven, *self._judged(driven, outcome), outcome.facts)
        with self.lock:
            self._forget_drive(outcome)

    def _forget_drive(self, outcome: Outcome) -> None:
        """No drive is on; one that could not start is not tried again and again."""
        if self._drive is not None and self._drive.state == FAILED:
            self.trouble = outcome.reason
        self._driven = self._drive = None
        self._is_begun = False
        self._idle.notify_all()

    def _judged(
        self, driven: tuple[str, str, int], outcome: Outcome
    ) -> tuple[dict[str, Any] | None, str]:
        """Measures of an attempt that is whole, and what to know of it."""
        if outcome.record is None or not outcome.reached_end:
            return None, outcome.reason
        steps = {each.id: each for each in self.session.steps_of(driven[0])}
        measures, said = measured(outcome.record, steps[driven[1]])
        return measures, "; ".join(each for each in (outcome.reason, said) if each)

    def _keep(
        self,
        driven: tuple[str, str, int],
        measures: dict[str, Any] | None,
        reason: str,
        latency: tuple[str, ...],
    ) -> None:
        """Write the end of an attempt, again and again while the disk is full."""
        while True:
            try:
                self.attempts.end(*driven, measures, reason, latency)
            except StoreError as error:
                self.trouble = str(error)
                if self._is_closing:
                    return  # it is judged at the next start
                time.sleep(1.0)  # without the lock: pages say what is wrong
                continue
            self.trouble = ""
            return

    def _end_practice(self) -> None:
        if self._drive is not None:
            self._drive.end(True, "")

    def leave_drive(self, reason: str) -> None:
        """End the drive that is on; what was driven is kept as aborted."""
        if self._drive is not None:
            self._drive.end(False, reason)

    def close(self) -> None:
        """End the drive that is on and close the store."""
        with self.lock:
            self._is_closing = True
            self.leave_drive("the session was closed")
            self.wait_until_idle()
        self.session.close()

    def wait_until_idle(self) -> None:
        """Wait until no drive is on any more; half a minute at most."""
        self._idle.wait_for(lambda: self._drive is None, timeout=30.0)
