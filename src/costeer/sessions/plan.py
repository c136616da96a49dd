"""What each participant does, in which order: the plan of a study with people.

The plan is a file of the lab. A block of trials is expanded for each participant by a
balanced order; the rest is the same for all. The plan that ships is the paper's
experiment (Sec. III-E, Fig. 8).
"""

from __future__ import annotations

import hashlib
import math
from collections import Counter
from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from costeer.loop.scenario import TrialSetup
from costeer.methods.conditions import MANUAL
from costeer.study.design import williams_square

KINDS = ("instruct", "consent", "ask", "practise", "drive", "break", "trials")
"""What a step of a plan can be."""

ORDERS = ("williams", "given", "random")
"""How the trials of a block are ordered."""

PLAN_FILE = "plan.yaml"
"""Name of the plan in the folder of a study."""

_ORDER_STREAM = 3


class PlanStep(NamedTuple):
    """One entry of a plan.

    Attributes:
        kind: One of `KINDS`.
        text: What is shown: a name of the text files, or the text itself.
        instrument: Questionnaire of `ask` and `consent`.
        condition: Of `practise` and `drive`.
        method: Of the drive; the plan's if empty.
        minutes: Shortest practice, or the length of a break [min].
        longest_minutes: Of a practice [min].
        sdlp_below: A practice is passed with a smaller SDLP [m]; NaN for no criterion.
        conditions: Of a block of trials.
        order: Of a block of trials, one of `ORDERS`.
        after: What follows each trial of a block.
        break_every: A break after so many trials of a block; 0 for none.
    """

    kind: str
    text: str = ""
    instrument: str = ""
    condition: str = ""
    method: str = ""
    minutes: float = math.nan
    longest_minutes: float = math.nan
    sdlp_below: float = math.nan
    conditions: tuple[str, ...] = ()
    order: str = "williams"
    after: tuple[PlanStep, ...] = ()
    break_every: int = 0


class Plan(NamedTuple):
    """A study with people.

    Attributes:
        title: Shown to participants.
        steps: In the order in which they come.
        language: Of texts, as `en`.
        participants: How many are planned.
        seed: Of leaders and of random orders.
        method: Guidance of the assisted trials.
        length: Of the course [m].
        speed_kmh: At the start, and suggested [km/h].
        car: Name of the car, or a file.
        intention: What starts a lane change: network, indicator or off.
        parameters: Dotted names and values; `costeer parameters` lists them.
        self_paced: Whether participants start their drives themselves.
        about: For people; anything.
    """

    title: str
    steps: tuple[PlanStep, ...]
    language: str = "en"
    participants: int = 12
    seed: int = 1
    method: str = "ibhs"
    length: float = 8000.0
    speed_kmh: float = 70.0
    car: str = "default"
    intention: str = "network"
    parameters: Mapping[str, float] = {}
    self_paced: bool = True
    about: str = ""


class Step(NamedTuple):
    """One thing that one participant does.

    Attributes:
        id: Of its own in this participant's session; names rows and files.
        kind: One of `KINDS` without `trials`, or `done`.
        text: What is shown.
        instrument: Questionnaire.
        condition: Of a drive; of the drive before for what follows a trial.
        method: Of a drive.
        minutes: Shortest practice or break [min].
        longest_minutes: Of a practice [min].
        sdlp_below: Criterion of a practice [m]; NaN for none.
        order: Place among the trials, from 1; 0 for what is no trial.
    """

    id: str
    kind: str
    text: str = ""
    instrument: str = ""
    condition: str = ""
    method: str = ""
    minutes: float = 0.0
    longest_minutes: float = 0.0
    sdlp_below: float = math.nan
    order: int = 0

    @property
    def drives(self) -> bool:
        """Whether somebody drives in it."""
        return self.kind in ("practise", "drive")


DONE = Step("done", "done")
"""After the last step."""


def plan_hash(plan: Plan) -> str:
    """What tells two plans apart, whatever their comments say."""
    return hashlib.sha256(repr(plan).encode()).hexdigest()[:16]


def session_steps(plan: Plan, slot: int) -> tuple[Step, ...]:
    """What a participant does, from the first step to `DONE`.

    Args:
        plan: Of the study.
        slot: Of the participant, from 1: it picks the order of the trials.
    """
    steps: list[Step] = []
    trials = 0
    before = ""
    for each in plan.steps:
        if each.kind == "trials":
            steps += _block(plan, each, slot, trials)
            trials += len(each.conditions)
            continue
        trials += each.kind == "drive"
        place = trials if each.kind == "drive" else 0
        before = each.condition or before
        steps.append(_step(plan, each, each.condition or before, place))
    return (*_numbered(steps), DONE)


def block_order(step: PlanStep, slot: int, seed: int) -> tuple[str, ...]:
    """Conditions of a block in the order in which a slot drives them."""
    names = step.conditions
    if step.order == "given":
        return names
    if step.order == "random":
        entropy = np.random.SeedSequence([seed, _ORDER_STREAM, slot])
        places = np.random.Generator(np.random.PCG64(entropy)).permutation(len(names))
        return tuple(names[place] for place in places)
    rows = williams_square(len(names))
    return tuple(names[place] for place in rows[(slot - 1) % len(rows)])


def _block(plan: Plan, step: PlanStep, slot: int, before: int) -> list[Step]:
    """Trials of a block, with what follows each and the breaks between."""
    steps: list[Step] = []
    order = block_order(step, slot, plan.seed)
    for count, name in enumerate(order, start=1):
        drive = PlanStep("drive", text=step.text, method=step.method)
        steps.append(_step(plan, drive, name, before + count))
        steps += [_step(plan, each, name, 0) for each in step.after]
        if step.break_every and count % step.break_every == 0 and count < len(order):
            minutes = 0.0 if math.isnan(step.minutes) else step.minutes
            steps.append(Step("break", "break", text="break", minutes=minutes))
    return steps


def _step(plan: Plan, each: PlanStep, condition: str, order: int) -> Step:
    """An entry of the plan for one participant; its id is made unique later."""
    drives = each.kind in ("practise", "drive")
    about = condition if drives else each.instrument.removeprefix(each.kind)
    follows = condition if each.kind == "ask" and condition else ""
    parts = [each.kind, about or each.text[:20], follows]
    words = "-".join(part for part in parts if part).lower()
    return Step(
        id="".join(c if c.isalnum() or c == "-" else "-" for c in words).strip("-"),
        kind=each.kind,
        text=each.text,
        instrument=each.instrument,
        condition=condition if drives or follows else "",
        method=(each.method or plan.method) if drives else "",
        minutes=0.0 if math.isnan(each.minutes) else each.minutes,
        longest_minutes=0.0
        if math.isnan(each.longest_minutes)
        else each.longest_minutes,
        sdlp_below=each.sdlp_below,
        order=order,
    )


def _numbered(steps: Sequence[Step]) -> list[Step]:
    """The steps with ids that are all different."""
    seen: Counter[str] = Counter()
    named = []
    for step in steps:
        seen[step.id] += 1
        again = f"-{seen[step.id]}" if seen[step.id] > 1 else ""
        named.append(step._replace(id=step.id + again))
    return named


def trial_of(plan: Plan, step: Step, slot: int) -> TrialSetup:
    """The trial that a step drives.

    Args:
        plan: Of the study.
        step: That drives.
        slot: Of the participant; it picks the leaders.
    """
    speed = plan.speed_kmh / 3.6
    practice = 1.5 * speed * 60.0 * step.longest_minutes
    return TrialSetup(
        participant=slot,
        seed=plan.seed,
        condition=step.condition,
        method=step.method,
        length=max(practice, 100.0) if step.kind == "practise" else plan.length,
        speed=speed,
        car=plan.car,
        events=True,
        parameters=tuple(plan.parameters.items()),
    )


class Balance(NamedTuple):
    """How balanced the orders of some slots are.

    Attributes:
        places: How often each condition stands in each place, `{name: counts}`.
        follows: How often each condition follows each other, `{(before, name): count}`.
    """

    places: dict[str, list[int]]
    follows: dict[tuple[str, str], int]

    @property
    def is_even(self) -> bool:
        """Whether no condition is favoured by place or predecessor."""
        places = [count for counts in self.places.values() for count in counts]
        return len(set(places)) <= 1 and len(set(self.follows.values())) <= 1


def balance(plan: Plan, slots: Sequence[int]) -> Balance:
    """How balanced the first block of trials is over some slots.

    Args:
        plan: Of the study.
        slots: Of the participants who count, each perhaps several times.
    """
    block = next((each for each in plan.steps if each.kind == "trials"), None)
    if block is None:
        return Balance({}, {})
    names = block.conditions
    places = {name: [0] * len(names) for name in names}
    follows = {(a, b): 0 for a in names for b in names if a != b}
    for slot in slots:
        order = block_order(block, slot, plan.seed)
        for place, name in enumerate(order):
            places[name][place] += 1
        for pair in pairwise(order):
            follows[pair] += 1
    return Balance(places, follows)


def manual_steps(steps: Sequence[Step]) -> list[Step]:
    """Trials without guidance."""
    return [each for each in steps if each.kind == "drive" and each.condition == MANUAL]
