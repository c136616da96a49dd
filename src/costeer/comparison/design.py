"""What is compared: methods, roads, mistakes and drivers, and who drives what.

All methods meet the same drivers, noise and traffic: a trial of one and a trial of
another with the same driver, road and mistake are a pair.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from costeer.comparison.entrants import Course, Entrant
from costeer.comparison.mistakes import (
    NONE,
    check_mistakes,
    contradiction,
    happens_on,
    with_mistake,
)
from costeer.loop.scenario import (
    TrialSetup,
    check_study_seed,
    loop_parameters,
)
from costeer.methods.conditions import condition
from costeer.methods.registry import METHODS, AnyMethod, method_named
from costeer.scenarios.definition import Scenario
from costeer.scenarios.reading import chosen
from costeer.study.configuration import LARGEST_SEED, MOST_PARTICIPANTS, check_count

SCENARIOS = (
    "expressway",
    "expressway-curves",
    "three-lanes",
    "dense-traffic",
    "cut-in",
    "crosswind",
)
"""Driven unless others are named: the paper's road, curves, a third lane, traffic, a
car that cuts in, gusts. Not the obstacle, which has a command of its own, and not the
paper's road at another speed and on the other side."""

BLOCK = 10
"""Drivers whose results are written together: a few seconds of work [-]."""


class ComparisonSettings(NamedTuple):
    """What the user of `costeer compare` decides.

    Attributes:
        methods: Names, places or methods; none: all that costeer has.
        scenarios: Names, files or scenarios.
        mistakes: Names of mistakes, one at a time.
        participants: How many virtual drivers.
        seed: Of drivers, traffic and noise.
        condition: Of the guidance, Table IV.
        intention: "scripted" (the driver's own plan is known), "network" or "off".
        length: Of every course; that of each scenario if None [m].
        keep_records: Whether the record of every trial is kept.
    """

    methods: tuple[str | AnyMethod, ...] = ()
    scenarios: tuple[str | Scenario, ...] = SCENARIOS
    mistakes: tuple[str, ...] = (NONE,)
    participants: int = 50
    seed: int = 1
    condition: str = "strong-normal"
    intention: str = "scripted"
    length: float | None = None
    keep_records: bool = False


class Cell(NamedTuple):
    """A method on a road with a mistake.

    Attributes:
        number: From 1, in the order of the tables.
        entrant: Who.
        course: Where.
        mistake: What goes wrong.
    """

    number: int
    entrant: Entrant
    course: Course
    mistake: str


class Block(NamedTuple):
    """Some drivers of a cell, whose results are written together.

    Attributes:
        cell: What they drive.
        participants: Their numbers.
    """

    cell: Cell
    participants: tuple[int, ...]


class LeftOut(NamedTuple):
    """A combination that contradicts itself, a row of `left_out.csv`."""

    method: str
    mistake: str
    reason: str


class Plan(NamedTuple):
    """Everything that is driven.

    Attributes:
        entrants: The methods.
        courses: The scenarios.
        cells: In the order of the tables.
        blocks: In the order of the work.
        left_out: Combinations that contradict themselves.
        notes: What a user should know.
    """

    entrants: tuple[Entrant, ...]
    courses: tuple[Course, ...]
    cells: tuple[Cell, ...]
    blocks: tuple[Block, ...]
    left_out: tuple[LeftOut, ...]
    notes: tuple[str, ...]


def checked(settings: ComparisonSettings) -> ComparisonSettings:
    """The settings, methods and mistakes in full.

    Raises:
        ValueError: Naming the first value that cannot be, and what can.
    """
    check_count("participants", settings.participants, 1, MOST_PARTICIPANTS)
    check_count("seed", settings.seed, 0, LARGEST_SEED)
    check_study_seed(settings.seed)
    if not condition(settings.condition).strength_factor:
        raise ValueError(
            f"condition {settings.condition} has no guidance; give one with it, as "
            "strong-normal: manual driving is a method here"
        )
    if not settings.scenarios:
        raise ValueError("scenarios is empty; name at least one")
    return settings._replace(
        methods=settings.methods or tuple(METHODS),
        mistakes=check_mistakes(settings.mistakes),
    )


def planned(settings: ComparisonSettings) -> Plan:
    """All trials, each of which can be driven.

    Args:
        settings: Checked.

    Raises:
        ValueError: If a method, a scenario or a trial cannot be.
        OSError: If a file cannot be read.
    """
    entrants = tuple(map(_entrant, settings.methods))
    found = [
        (given, chosen(given, settings.length, None)) for given in settings.scenarios
    ]
    courses = tuple(
        Course(each.scenario.name, given, each.length, each.speed)
        for given, each in found
    )
    _refuse_twins("method", [each.name for each in entrants])
    _refuse_twins("scenario", [each.name for each in courses])
    left_out = _left_out(settings, entrants, courses)
    cells = cells_of(entrants, courses, settings.mistakes, left_out)
    for cell in cells:
        loop_parameters(setup_of(settings, cell, 1))
    return Plan(
        entrants=entrants,
        courses=courses,
        cells=cells,
        blocks=blocks_of(cells, settings.participants),
        left_out=left_out,
        notes=tuple(note for _, each in found for note in each.notes),
    )


def setup_of(settings: ComparisonSettings, cell: Cell, participant: int) -> TrialSetup:
    """The trial of a driver: noise depends on seed, participant and condition alone."""
    course = cell.course
    setup = TrialSetup(
        participant=participant,
        seed=settings.seed,
        condition=settings.condition,
        method=cell.entrant.given,
        length=course.length,
        speed=course.speed,
        intention=settings.intention,
        scenario=course.given,
    )
    return with_mistake(setup, cell.mistake)


def num_trials(blocks: Sequence[Block]) -> int:
    """How many trials there are [-]."""
    return sum(len(block.participants) for block in blocks)


def _entrant(given: str | AnyMethod) -> Entrant:
    method = method_named(given)
    return Entrant(method.name, given, method.assists)


def _refuse_twins(what: str, names: list[str]) -> None:
    for name in names:
        if names.count(name) > 1:
            raise ValueError(f"{what} {name} is given twice; name each once")


def _left_out(
    settings: ComparisonSettings,
    entrants: tuple[Entrant, ...],
    courses: tuple[Course, ...],
) -> tuple[LeftOut, ...]:
    return tuple(
        LeftOut(entrant.name, mistake, reason)
        for entrant in entrants
        for mistake in settings.mistakes
        if (reason := contradiction(mistake, entrant, courses, settings.intention))
    )


def cells_of(
    entrants: Sequence[Entrant],
    courses: Sequence[Course],
    mistakes: Sequence[str],
    left_out: Sequence[LeftOut],
) -> tuple[Cell, ...]:
    """All combinations but those that are left out, in the order of the tables."""
    without = {(each.method, each.mistake) for each in left_out}
    kinds = [
        (entrant, course, mistake)
        for course in courses
        for mistake in mistakes
        for entrant in entrants
        if (entrant.name, mistake) not in without and happens_on(mistake, course)
    ]
    return tuple(Cell(number, *kind) for number, kind in enumerate(kinds, 1))


def blocks_of(cells: Sequence[Cell], participants: int) -> tuple[Block, ...]:
    """Blocks, those of the first drivers first.

    What is there of an unfinished comparison can then be compared.
    """
    everybody = range(1, participants + 1)
    return tuple(
        Block(cell, tuple(everybody[start : start + BLOCK]))
        for start in range(0, participants, BLOCK)
        for cell in cells
    )
