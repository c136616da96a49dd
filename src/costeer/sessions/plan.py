"""What each participant does, in which order: the plan of a study with people.

The plan is a file of the lab. A block of trials is expanded for each participant by a
balanced order; the rest is the same for all. The plan that ships is the paper's
experiment (Sec. III-E, Fig. 8).
"""

from __future__ import annotations

import hashlib
import math
import re
from collections import Counter
from collections.abc import Mapping, Sequence, Set
from itertools import count
from typing import NamedTuple

import numpy as np

from costeer.loop.scenario import TrialSetup
from costeer.scenarios.definition import Scenario
from costeer.scenarios.reading import chosen
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
        scenario: Of a drive or block, a name or a file beside the plan; the plan's if
            empty.
        label: Put behind the condition to tell drives of the same one apart.
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
    scenario: str = ""
    label: str = ""


class Plan(NamedTuple):
    """A study with people.

    Attributes:
        title: Shown to participants.
        steps: In the order in which they come.
        language: Of texts, as `en`.
        participants: How many are planned.
        seed: Of leaders and of random orders.
        method: Guidance of the assisted trials.
        length: Of the course [m]; that of the scenario's road if NaN.
        speed_kmh: At the start, and suggested [km/h]; the scenario's if NaN.
        scenario: Of drives that name none, a name or a file beside the plan.
        car: Name of the car.
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
    length: float = math.nan
    speed_kmh: float = math.nan
    scenario: str = "expressway"
    car: str = "default"
    intention: str = "network"
    parameters: Mapping[str, float] = {}
    self_paced: bool = True
    about: str = ""

    @property
    def speed(self) -> float:
        """At the start, and suggested [m/s]; NaN for the scenario's."""
        return self.speed_kmh / 3.6


class Trial(NamedTuple):
    """What is driven in a step.

    Attributes:
        condition: Of Table IV.
        scenario: Name or file.
        label: Names a trial among all that a participant drives: the condition, and
            what tells it from others of it; empty for a practice.
        occasion: How often its condition was planned on its scenario so far, from 1; 0
            for a practice.
    """

    condition: str
    scenario: str
    label: str = ""
    occasion: int = 0

    @property
    def name(self) -> str:
        """Of the trial, or of what is practised."""
        return self.label or self.condition


_NOTHING = Trial("", "")


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
        scenario: Of a drive: a name, or a file beside the plan.
        label: Of a trial, and of what follows it: `Trial.label`.
        occasion: Of a trial: `Trial.occasion`.
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
    scenario: str = ""
    label: str = ""
    occasion: int = 0

    @property
    def drives(self) -> bool:
        """Whether somebody drives in it."""
        return self.kind in ("practise", "drive")


DONE = Step("done", "done")
"""After the last step."""


def plan_hash(plan: Plan, scenarios: Mapping[str, str]) -> str:
    """What tells two plans apart, whatever their comments say.

    Args:
        plan: As it was read.
        scenarios: Text of each of its scenarios by name.
    """
    told = repr((plan, sorted(scenarios.items())))
    return hashlib.sha256(told.encode()).hexdigest()[:16]


def given_or_none(value: float) -> float | None:
    """A number of a plan; None where it leaves it to the scenario."""
    return None if math.isnan(value) else value


def planned_trials(plan: Plan) -> dict[tuple[int, str], Trial]:
    """Trials of a plan by the place of their step and their condition.

    Labels follow from the plan, not from the order in which somebody drives.
    """
    found: dict[tuple[int, str], Trial] = {}
    labels = set[str]()
    for place, each in enumerate(plan.steps):
        for name in trial_conditions(each):
            where = each.scenario or plan.scenario
            alike = [t for t in found.values() if t[:2] == (name, where)]
            label = _label(name, each, plan, labels)
            labels.add(label)
            found[place, name] = Trial(name, where, label, len(alike) + 1)
    return found


def trial_conditions(each: PlanStep) -> tuple[str, ...]:
    """Conditions that an entry of a plan drives as trials."""
    if each.kind == "trials":
        return each.conditions
    return (each.condition,) if each.kind == "drive" else ()


def _label(name: str, each: PlanStep, plan: Plan, taken: Set[str]) -> str:
    """A condition, and behind it what tells the trial from others of it."""
    elsewhere = each.scenario not in ("", plan.scenario)
    more = each.label or (scenario_word(each.scenario) if elsewhere else "")
    label = f"{name}-{more}" if more else name
    if each.label or label not in taken:
        return label
    return next(again for n in count(2) if (again := f"{label}-{n}") not in taken)


def scenario_word(scenario: str) -> str:
    """A scenario in names of files and labels: letters, digits and hyphens."""
    stem = scenario.rpartition("/")[2].rpartition(".")[0] or scenario
    return "-".join(re.findall(r"[a-z0-9]+", stem.lower())) or "scenario"


def session_steps(plan: Plan, slot: int) -> tuple[Step, ...]:
    """What a participant does, from the first step to `DONE`.

    Args:
        plan: Of the study.
        slot: Of the participant, from 1: it picks the order of the trials.
    """
    planned = planned_trials(plan)
    steps: list[Step] = []
    trials = 0
    before = _NOTHING
    for place, each in enumerate(plan.steps):
        if each.kind == "trials":
            order = block_order(each, slot, plan.seed)
            driven = [planned[place, name] for name in order]
            steps += _block(plan, each, driven, trials)
            trials, before = trials + len(driven), driven[-1]
            continue
        if each.kind == "drive":
            trials, before = trials + 1, planned[place, each.condition]
        elif each.kind == "practise":
            before = Trial(each.condition, each.scenario or plan.scenario)
        steps.append(_step(plan, each, before, trials if each.kind == "drive" else 0))
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


def _block(
    plan: Plan, step: PlanStep, driven: Sequence[Trial], before: int
) -> list[Step]:
    """Trials of a block, with what follows each and the breaks between."""
    steps: list[Step] = []
    for place, trial in enumerate(driven, start=1):
        drive = PlanStep("drive", text=step.text, method=step.method)
        steps.append(_step(plan, drive, trial, before + place))
        steps += [_step(plan, each, trial, 0) for each in step.after]
        is_due = step.break_every and place % step.break_every == 0
        if is_due and place < len(driven):
            minutes = 0.0 if math.isnan(step.minutes) else step.minutes
            steps.append(Step("break", "break", text="break", minutes=minutes))
    return steps


def _step(plan: Plan, each: PlanStep, trial: Trial, order: int) -> Step:
    """An entry of the plan for one participant; its id is made unique later.

    Args:
        plan: Of the study.
        each: The entry.
        trial: That it drives, or that was driven before it.
        order: Place among the trials.
    """
    drives = each.kind in ("practise", "drive")
    about = trial.name if drives else each.instrument.removeprefix(each.kind)
    follows = trial.name if each.kind == "ask" else ""
    parts = [each.kind, about or each.text[:20], follows]
    words = "-".join(part for part in parts if part).lower()
    has_trial = drives or each.kind == "ask"
    return Step(
        id="".join(c if c.isalnum() or c == "-" else "-" for c in words).strip("-"),
        kind=each.kind,
        text=each.text,
        instrument=each.instrument,
        condition=trial.condition if has_trial else "",
        method=(each.method or plan.method) if drives else "",
        minutes=_number(each.minutes),
        longest_minutes=_number(each.longest_minutes),
        sdlp_below=each.sdlp_below,
        order=order,
        scenario=trial.scenario if drives else "",
        label=trial.label if has_trial else "",
        occasion=trial.occasion if each.kind == "drive" else 0,
    )


def _number(value: float) -> float:
    return 0.0 if math.isnan(value) else value


def _numbered(steps: Sequence[Step]) -> list[Step]:
    """The steps with ids that are all different."""
    seen: Counter[str] = Counter()
    named = []
    for step in steps:
        seen[step.id] += 1
        again = f"-{seen[step.id]}" if seen[step.id] > 1 else ""
        named.append(step._replace(id=step.id + again))
    return named


def trial_of(plan: Plan, step: Step, slot: int, scenario: Scenario) -> TrialSetup:
    """The trial that a step drives.

    Args:
        plan: Of the study.
        step: That drives.
        slot: Of the participant; it picks the leaders.
        scenario: That the step names.

    Raises:
        ValueError: If a curve of the scenario is too tight for the speed.
    """
    length, speed = given_or_none(plan.length), given_or_none(plan.speed)
    course = chosen(scenario, length, speed)
    practice = 1.5 * course.speed * 60.0 * step.longest_minutes
    return TrialSetup(
        participant=slot,
        seed=plan.seed,
        condition=step.condition,
        method=step.method,
        length=max(practice, 100.0) if step.kind == "practise" else course.length,
        speed=course.speed,
        car=plan.car,
        events=True,
        parameters=tuple(plan.parameters.items()),
        scenario=scenario,
    )
