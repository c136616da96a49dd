"""What the server does for a session: the participant's steps and the console's wishes.

Every method may be called from any thread; one lock keeps them apart. What changes the
store has changed it before it returns.
"""

from __future__ import annotations

import math
import threading
import time
from collections.abc import Mapping
from typing import Any

from costeer.devices.wheels.simulated import in_hands_of
from costeer.runtime.setup import DriveSetup, check_drive
from costeer.runtime.stream import record_paths
from costeer.sessions.attempts import Attempts
from costeer.sessions.breaks import break_left
from costeer.sessions.plan import Step
from costeer.sessions.questionnaires.answers import checked_answers
from costeer.sessions.session import Session
from costeer.sessions.standing import ENDED, OutOfStepError, Standing
from costeer.sessions.stopping import stop_taking_part, take_part_again
from costeer.sessions.store import StoreError
from costeer.sessions.wellbeing import held, unwell
from costeer.web.drive import PageOptions
from costeer.web.sessions.devices import Devices, facts_of
from costeer.web.sessions.judged import LiveCriterion, driven_whole, measured
from costeer.web.sessions.shown import ShownSteps, is_enough
from costeer.web.sessions.step_drive import FAILED, Outcome, StepDrive
from costeer.web.sessions.wording import Wording

# Any, in this file: of JSON.


MOST_LAME = 3
"""After so many drives that broke before anybody drove, someone must look."""


class Desk:
    """The session as its pages see it.

    Args:
        session: Of the study.
        devices: Of the lab.
    """

    def __init__(self, session: Session, devices: Devices) -> None:
        self.session, self.devices = session, devices
        self.attempts = Attempts(session, driven_whole)
        self.wording = Wording(session.folder)
        self._shown = ShownSteps(session, self.wording)
        self.lock = threading.RLock()
        self._idle = threading.Condition(self.lock)
        self.participant = ""
        self._drive: StepDrive | None = None
        self._driven: tuple[str, str, int] | None = None
        self.criterion: LiveCriterion | None = None
        self._is_begun = False
        self._num_lame = 0
        self.checked: list[dict[str, Any]] = []
        self.trouble = ""
        self.page_seen = -math.inf
        self.pictures: int | None = None  # a second, in the page that drives
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
                "texts": self.wording.pages(language),
                "trouble": self.trouble,
            }
            if standing is None:
                return told | {"participant": "", "step": None, "stopped": ""}
            stopped = self._stopped(standing.participant)
            if not stopped:
                self._prepare(standing)
            attempt = self._attempt(standing)
            return told | {
                "participant": standing.participant,
                "step": self._shown.shown(
                    standing, self._drive, attempt, self.criterion
                ),
                "stopped": stopped,
                "held": bool(held(self.session, standing.participant)),
            }

    def hear_pictures(self, told: str) -> None:
        """Take how well the page that drives draws; other pages tell nothing."""
        if told.isascii() and told.isdigit() and len(told) <= 3:
            self.pictures = int(told)

    def _attempt(self, standing: Standing) -> int:
        """Number of the drive that is on or comes next in the step that is on."""
        if self._driven is not None and self._driven[1] == standing.step.id:
            return self._driven[2]
        return 1 + max((int(row["attempt"]) for row in standing.attempts), default=0)

    def _stopped(self, participant: str) -> str:
        """In which words the participant has stopped; empty who takes part."""
        row = self.session.person(participant)
        return str(row["reason"]) if row["status"] in ENDED else ""

    def _language(self) -> str:
        if not self.participant:
            return self.session.plan.language
        return self.session.language_of(self.participant)

    # What participants do

    def next(self, participant: str, step: str) -> dict[str, Any]:
        """Go on from a step that needs nothing else, or from practice.

        Raises:
            ValueError: If it is not that far.
            OutOfStepError: If it is somebody else's, or who it is of has stopped.
            OSError: If it cannot be kept.
        """
        with self.lock:
            standing = self._of(participant)
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
        if on.kind == "break" and break_left(self.session, standing) > 0.0:
            raise ValueError("the break is not over yet")
        if on.kind == "practise":
            if not is_enough(on, self._drive):
                raise ValueError(f"practise for at least {on.minutes:g} min")
            if self.criterion is not None and not self.criterion.is_met:
                raise ValueError("practise until the car keeps its lane steadily")
            if self._drive is not None:  # what is met now is not judged again
                self._drive.end(True, "", True)
            return
        self.session.finish(standing.participant, on.id)

    def answers(
        self, participant: str, step: str, given: Mapping[str, Any]
    ) -> dict[str, Any]:
        """Take the answers of a step.

        Raises:
            ValueError: If one is missing or cannot be, or another step is on.
            OutOfStepError: If they are somebody else's, or who gives them has stopped.
            OSError: If they cannot be kept.
        """
        with self.lock:
            who = self._of(participant).participant
            steps = {each.id: each for each in self.session.steps_of(who)}
            if step not in steps or steps[step].kind not in ("ask", "consent"):
                raise ValueError(f"step '{step}' asks nothing")
            instrument = self._shown.instrument(who, steps[step])
            checked = checked_answers(instrument, given)
            about = instrument.name, instrument.version
            why = unwell(self.session, who, step, instrument, checked)
            self.session.answer(who, step, checked, about, why)
            return self.state()

    def stop_taking_part(self, participant: str, deletes: bool) -> dict[str, Any]:
        """Keep that the participant takes no part, and end what is driven.

        Raises:
            OutOfStepError: If another is here, or the session is over.
            OSError: If it cannot be kept.
        """
        with self.lock:
            self._here(participant)
            self.leave_drive("the participant stopped")
            stop_taking_part(self.session, participant, deletes)
            return self.state()

    def take_part_again(self, participant: str) -> dict[str, Any]:
        """Let the participant who had stopped go on.

        Raises:
            OutOfStepError: If another is here.
            OSError: If it cannot be kept.
        """
        with self.lock:
            self._here(participant)
            take_part_again(self.session, participant)
            return self.state()

    def _here(self, participant: str) -> Standing:
        """Where who a page is for stands; a page may be another participant's.

        Raises:
            OutOfStepError: If it is.
        """
        standing = self.present()
        if standing.participant != participant:
            raise OutOfStepError("another participant is here now")
        return standing

    def _of(self, participant: str) -> Standing:
        """As `_here`, of who has not stopped.

        Raises:
            OutOfStepError: If the participant has.
        """
        standing = self._here(participant)
        if self._stopped(participant):
            raise OutOfStepError(f"participant {participant} has stopped")
        return standing

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
            is_due = ahead[0].id == standing.step.id and not self._is_begun
            if is_due and not held(self.session, who):
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
            setup, checked = self._drive.setup, self.checked
            facts = facts_of(self.devices, setup, checked, self.pictures)
            self.attempts.start(who, step.id, facts)
            self._is_begun = True

    def _start(self, who: str, step: Step) -> None:
        """Start the processes of an attempt.

        Raises:
            ValueError: If the drive cannot be.
            OSError: If nothing can be written.
        """
        plan, slot = self.session.plan_of(who), int(self.session.person(who)["slot"])
        trial = self.session.trial_of(who, step)
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
        has_criterion = not math.isnan(step.sdlp_below)
        stream = record_paths(record).stream
        self.criterion = LiveCriterion(step, stream) if has_criterion else None
        options = PageOptions(self.devices.input, False, plan.self_paced, False)
        self._drive = StepDrive(setup, record, options, self._end)
        self._drive.begin()

    def _end(self, outcome: Outcome) -> None:
        """Keep how an attempt ended; called in a thread of the drive.

        Pages are answered while the record is measured and written.
        """
        with self.lock:
            driven, is_begun = self._driven, self._is_begun
        if driven is None:
            return
        try:
            if is_begun:
                self._keep(driven, *self._judged(driven, outcome), outcome.facts)
        finally:  # whatever cannot be measured, the next drive begins
            with self.lock:
                self._forget_drive(outcome)

    def _forget_drive(self, outcome: Outcome) -> None:
        """No drive is on; one that could not start is not tried again and again."""
        if self._drive is not None and self._drive.state == FAILED:
            self.trouble = outcome.reason
        is_lame = self._drive is not None and self._drive.broke_unstarted
        self._num_lame = self._num_lame + 1 if is_lame else 0
        if self._num_lame >= MOST_LAME:
            self.trouble, self._num_lame = outcome.reason, 0
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
        step = steps[driven[1]]
        measures, said = measured(outcome.record, step, outcome.is_waived)
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

    def wait_until_idle(self) -> bool:
        """Wait until no drive is on any more, half a minute at most; whether it is."""
        return self._idle.wait_for(lambda: self._drive is None, timeout=30.0)
