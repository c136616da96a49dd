"""A step as the participant's page takes it."""

from __future__ import annotations

import hashlib
import math
from typing import Any

from costeer.sessions.breaks import break_left
from costeer.sessions.plan import Step
from costeer.sessions.questionnaires.instrument import Instrument, rendered
from costeer.sessions.session import Session
from costeer.sessions.standing import Standing
from costeer.web.sessions.judged import LiveCriterion
from costeer.web.sessions.step_drive import StepDrive
from costeer.web.sessions.wording import Wording

# Any, in this file: of JSON.


class ShownSteps:
    """What is shown of steps.

    Args:
        session: Of the study.
        wording: Its words.
    """

    def __init__(self, session: Session, wording: Wording) -> None:
        self._session, self._wording = session, wording

    def shown(
        self,
        standing: Standing,
        drive: StepDrive | None,
        attempt: int,
        criterion: LiveCriterion | None = None,
    ) -> dict[str, Any]:
        """A step that is on.

        Args:
            standing: Of the participant.
            drive: That is on; None without one.
            attempt: Number of the drive among those of its step; 0 without one.
            criterion: Of the practice that is on.
        """
        step, who = standing.step, standing.participant
        shown: dict[str, Any] = {
            "id": step.id,
            "kind": step.kind,
            **self._words(who, step),
            "condition": step.condition,
            "number": standing.number,
            "of": standing.of,
            "minutes": step.minutes,
            "order": step.order,
            "trials": sum(e.kind == "drive" for e in self._session.steps_of(who)),
            "self_paced": self._session.plan_of(who).self_paced,
        }
        if step.kind in ("ask", "consent"):
            shown["instrument"] = rendered(
                self.instrument(who, step), self._seed(who, step)
            )
        if step.kind == "break":
            # Rounded up: a page that shows 0 may go on.
            shown["remaining"] = math.ceil(break_left(self._session, standing))
        if step.drives:
            shown["drive"] = {"state": "waiting"} if drive is None else drive.told()
            shown["attempt"] = attempt
            shown["enough"] = is_enough(step, drive)
            if criterion is not None and not math.isnan(step.sdlp_below):
                shown["criterion"] = criterion.told()
        return shown

    def _words(self, who: str, step: Step) -> dict[str, str]:
        """Heading and text of a step: of the text files, or the plan's own."""
        pages = self._wording.pages(self._session.language_of(who))
        text = pages.get(f"{step.text}_text", step.text)
        return {"title": pages.get(f"{step.text}_title", ""), "text": text}

    def instrument(self, who: str, step: Step) -> Instrument:
        """Questionnaire of a step in a participant's language."""
        return self._wording.instrument(step.instrument, self._session.language_of(who))

    def _seed(self, who: str, step: Step) -> int:
        """Of a questionnaire's random order: the same after a reload."""
        told = f"{self._session.plan_of(who).seed} {who} {step.id}"
        return int.from_bytes(hashlib.sha256(told.encode()).digest()[:7])


def is_enough(step: Step, drive: StepDrive | None) -> bool:
    """Whether a practice was long enough."""
    seconds = 0.0 if drive is None else drive.seconds
    return step.kind == "practise" and seconds >= 60.0 * step.minutes
