"""What every method of assistance must be, looked for one after another."""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from importlib.util import find_spec
from typing import Any, NamedTuple

import numpy as np

from costeer.base.array import Real
from costeer.base.described import value_at
from costeer.base.entry import entry_for
from costeer.base.packing import leaf_names, packed, unpack
from costeer.controller.signals import Request
from costeer.loop.noise import driver_noise
from costeer.loop.parameters import DT
from costeer.loop.rollout import cannot_compile, rollout
from costeer.loop.rows import writer_of
from costeer.loop.scenario import TrialSetup, loop_parameters
from costeer.loop.tick import INTENTION_SCRIPTED, PREDICTION_HORIZON, Script
from costeer.loop.trial import idle_network
from costeer.methods.conditions import CONDITIONS
from costeer.methods.interface import compiled_once, usual_parameters
from costeer.methods.registry import AnyMethod, method_named
from costeer.plant.parameters import ColumnParameters, RoadParameters
from costeer.plant.road import cruising_lane
from costeer.records.columns import COLUMNS, Column
from costeer.sensing.measurement import standing_start
from costeer.testing.drive import (
    Drive,
    MethodError,
    Moment,
    Rows,
    driven,
    mirrored_moment,
    random_drive,
    same,
    strong_parameters,
    without_signals,
)

LOOP_STEPS = 120
"""Steps of the closed loop in each engine."""

AGREEMENT = 1e-9
"""Two numbers that rounding parts differ by less, relative to the largest or to 1."""


class Finding(NamedTuple):
    """One property that was looked at.

    Attributes:
        name: Of the property.
        said: What was seen.
    """

    name: str
    said: str


class Report(NamedTuple):
    """What was seen of a method that has all properties.

    Attributes:
        method: Its name and version.
        findings: In the order in which they were looked for.
    """

    method: str
    findings: tuple[Finding, ...]

    def __str__(self) -> str:
        """A line for each finding."""
        lines = [f"{each.name:<10} {each.said}" for each in self.findings]
        return "\n".join([f"method {self.method}", *lines])


ENGINES = ("python", "numba")
"""That run a whole trial; JAX has a switch of its own."""


def check_method(
    method: str | AnyMethod,
    *,
    engines: Sequence[str] = ("python", "numba"),
    jax: bool | None = None,
    seed: int = 1,
) -> Report:
    """Check that a method has the properties that every method must have.

    Args:
        method: The method, its name, or where it is.
        engines: That run it; the first is the one that others are compared with.
        jax: Whether JAX must run it too; None: told if it does and JAX is installed.
        seed: Of the random drive.

    Returns:
        What was seen; print it.

    Raises:
        MethodError: Naming the first property that it lacks, and the values.
        ValueError: If there is no such method, it cannot be called, or the engines
            are none.

    Example:
        print(check_method("examples/methods/pi_keeping.py"))
    """
    found = method_named(method)
    if isinstance(engines, str) or not set(engines) <= set(ENGINES) or not engines:
        raise ValueError(f"engines are {engines!r}; give some of {ENGINES}")
    if seed < 0:
        raise ValueError(f"seed is {seed}; give 0 or more")
    columns = writer_of(found).columns[len(COLUMNS) :]
    names = ", ".join(column.name for column in columns) or "none of its own"
    moments = random_drive(np.random.default_rng(seed), RoadParameters())
    drive = driven(found, moments, RoadParameters())
    findings = [
        Finding("made of", _made_of(found)),
        Finding("columns", names),
        Finding("pure", _check_pure(found, moments, drive)),
        Finding("finite", _check_finite(found, moments, drive)),
        Finding("bounded", _check_bounded(found, drive)),
        Finding("NaN", _check_missing(found, moments)),
        Finding("mirrored", _check_mirrored(found, moments, drive)),
        Finding("engines", _check_engines(found, engines, jax)),
    ]
    if "numba" in engines:
        findings.append(Finding("speed", _check_compiled_step(found, moments, drive)))
    return Report(f"{found.name} {found.version}", tuple(findings))


def _made_of(method: AnyMethod) -> str:
    """How many numbers a method has and remembers; `method_named` has judged them."""
    given = usual_parameters(method)
    state = method.initial_state(given, 1.0)
    return f"{len(leaf_names(given))} parameters, {packed(state).size} numbers of state"


def _check_pure(method: AnyMethod, moments: Sequence[Moment], first: Drive) -> str:
    """Refuse a method that answers the same drive in another way.

    Raises:
        MethodError: Naming the step and the torques.
    """
    again = driven(method, moments, RoadParameters())
    for k, (one, other) in enumerate(zip(first.answers, again.answers, strict=True)):
        if not same(packed(one), packed(other)):
            raise MethodError(
                f"method '{method.name}' is not pure: the same drive again gives "
                f"{other.applied_torque:g} N·m at step {k} instead of "
                f"{one.applied_torque:g}; keep what it remembers in its state"
            )
    return (
        "the same drive gives the same answers and nothing given is changed (in "
        "Python; compiled code may use up the old state)"
    )


def _check_finite(method: AnyMethod, moments: Sequence[Moment], drive: Drive) -> str:
    """Refuse a torque that is no number although all signals are.

    Raises:
        MethodError: Naming step, torque and measurement.
    """
    torques = drive.torques
    wrong = np.flatnonzero(~np.isfinite(torques))
    if wrong.size:
        raise MethodError(
            f"method '{method.name}' is not finite: it asks for {torques[wrong[0]]} "
            f"N·m at step {wrong[0]}, given {moments[wrong[0]].measurement}"
        )
    return f"all torques of {len(torques)} random steps"


def _check_bounded(method: AnyMethod, drive: Drive) -> str:
    """Refuse a torque that the motor cannot give, or any if it does not assist.

    Raises:
        MethodError: Naming step, torque and limit.
    """
    limit = ColumnParameters().torque_limit if method.assists else 0.0
    torques = np.abs(drive.torques)
    most = int(np.argmax(torques))
    if torques[most] > limit:
        raise MethodError(
            f"method '{method.name}' is not bounded: it asks for {torques[most]:g} N·m "
            f"at step {most}, more than {limit:g} N·m; the loop would clip it and call "
            "it a fault: clip it in the method"
        )
    return f"at most {torques[most]:.3g} N·m, the motor gives {limit:g} N·m"


def _check_missing(method: AnyMethod, moments: Sequence[Moment]) -> str:
    """What becomes of a sample whose signals are all NaN; it must not break.

    Raises:
        MethodError: If it breaks.
    """
    middle = len(moments) // 2
    broken = [*moments]
    broken[middle] = without_signals(moments[middle])
    torques = driven(method, broken, RoadParameters()).torques[middle:]
    faults = int(np.count_nonzero(~np.isfinite(torques)))
    if not faults:
        return "a sample of NaN gives a finite torque"
    after = (
        f"for {faults} steps" if np.isfinite(torques[-1]) else "until the trial ends"
    )
    return (
        f"a sample of NaN gives no number {after}; the loop gives 0 N·m instead and "
        "counts each as a fault"
    )


def _check_mirrored(method: AnyMethod, moments: Sequence[Moment], here: Drive) -> str:
    """Refuse a method that knows left from right other than by what it is given.

    Raises:
        MethodError: Naming step and numbers.
    """
    road = RoadParameters()
    there = road._replace(overtaking_side=-road.overtaking_side)
    other = driven(method, [mirrored_moment(m, road) for m in moments], there)
    _check_opposite(method, "torque", -here.torques, other.torques)
    for column in writer_of(method).columns[len(COLUMNS) :]:
        if not column.source.startswith("method."):
            continue
        place = column.source.removeprefix("method.")
        one, two = (
            np.array([value_at(state, place) for state in drive.states], float)
            for drive in (here, other)
        )
        wanted = _mirrored_values(column, one, road)
        _check_opposite(method, f"column {column.name}", wanted, two)
    return "the mirrored drive gives the mirrored torque"


def _mirrored_values(column: Column, values: Rows, road: RoadParameters) -> Rows:
    """A column as its declaration says that the mirrored world shows it."""
    last = road.num_lanes - 1.0
    return {
        "same": values,
        "flipped": -values,
        "swapped": last - values,
        "reflected": -last * road.lane_width - values,
    }[column.mirrored]


def _check_opposite(method: AnyMethod, what: str, wanted: Rows, found: Rows) -> None:
    apart = _apart(wanted, found)
    worst = int(np.argmax(apart))
    if apart[worst] > AGREEMENT:
        raise MethodError(
            f"method '{method.name}' is not mirrored: {what} is {found[worst]:g} at "
            f"step {worst} of the mirrored drive and should be {wanted[worst]:g}; the "
            "method takes a side of its own, or a column says the wrong `mirrored`"
        )


def _apart(one: Rows, other: Rows) -> Rows:
    """Difference of numbers relative to the largest or to 1; NaN equals NaN."""
    scale = max(1.0, float(np.nanmax(np.abs(np.append(one, 0.0)))))
    apart = np.abs(one - other) / scale
    both = np.isnan(one) & np.isnan(other)
    return np.where(both, 0.0, np.where(np.isnan(apart), np.inf, apart))


def _check_engines(method: AnyMethod, engines: Sequence[str], jax: bool | None) -> str:
    """Refuse a method whose closed loop is another one in another engine.

    Raises:
        MethodError: Naming engine, column and values.
    """
    usual = _closed_loop(method, engines[0])
    for engine in engines[1:]:
        _check_rows(method, engine, _closed_loop(method, engine), usual)
    told = " and ".join(engines) + (" agree" if len(engines) > 1 else " runs")
    if jax is False or (jax is None and find_spec("jax") is None):
        return f"{told}; not tried in jax"
    try:
        rows = _closed_loop(method, "jax")
    except Exception as error:  # whatever JAX raises of somebody else's code
        first = str(error).partition("\n")[0]
        if jax:
            raise MethodError(
                f"method '{method.name}' does not run in jax: {first}; choose with "
                "xp.select instead of `if`, and change no array in place"
            ) from error
        return f"{told}; jax cannot run it: {first}"
    _check_rows(method, "jax", rows, usual)
    return f"{told}; jax agrees"


def _closed_loop(method: AnyMethod, engine: str) -> Rows:
    """Two seconds of a trial with a lane change."""
    setup = TrialSetup(condition=CONDITIONS[1].name, method=method, initial_offset=0.3)
    parameters = loop_parameters(setup)
    noise = driver_noise(setup.seed, setup.participant, setup.condition, LOOP_STEPS)
    script = Script(INTENTION_SCRIPTED, PREDICTION_HORIZON, np.array([0.5]))
    return rollout(method, parameters, script, idle_network(), noise, engine)


def _check_rows(method: AnyMethod, engine: str, rows: Rows, usual: Rows) -> None:
    for place, column in enumerate(writer_of(method).columns):
        apart = _apart(usual[:, place], rows[:, place])
        worst = int(np.argmax(apart))
        if apart[worst] > AGREEMENT:
            raise MethodError(
                f"engines do not agree on method '{method.name}': {column.name} is "
                f"{rows[worst, place]:g} in {engine} at step {worst}, and "
                f"{usual[worst, place]:g} in the first"
            )


def _compiled_drive(method: AnyMethod) -> Any:  # Any: a compiled function of Numba
    """A drive in compiled code, which leaves the torque of each step."""
    begin, step = method.initial_state, method.step
    like = usual_parameters(method)
    like_moment = Moment(standing_start(RoadParameters()), Request())

    def steps(parameters: Rows, moments: Rows, lane: Real, torques: Rows) -> None:
        given = unpack(like, parameters)
        state = begin(given, lane)
        for k in range(len(moments)):
            now = unpack(like_moment, moments[k])
            state, said = step(given, state, now.measurement, now.request, DT)
            torques[k] = said.applied_torque

    return entry_for((begin, step), steps)


def _check_compiled_step(
    method: AnyMethod, moments: Sequence[Moment], drive: Drive
) -> str:
    """Refuse a step that gives other torques when it is compiled; tell how fast it is.

    Raises:
        MethodError: Naming step and torques.
    """
    road = RoadParameters()
    given = packed(strong_parameters(method, road))
    table = np.array([packed(moment) for moment in moments])
    torques = np.empty(len(moments))
    try:
        run = compiled_once(_compiled_drive, method)
        run(given, table, cruising_lane(road), torques)
    except Exception as error:  # whatever Numba raises of somebody else's code
        raise MethodError(cannot_compile(f"method '{method.name}'", error)) from error
    expected = drive.torques
    apart = _apart(expected, torques)
    worst = int(np.argmax(apart))
    if apart[worst] > AGREEMENT:
        raise MethodError(
            f"engines do not agree on method '{method.name}': compiled it asks for "
            f"{torques[worst]:g} N·m at step {worst} of the random drive, in Python "
            f"for {expected[worst]:g}"
        )
    best = math.inf
    for _ in range(20):
        begun = time.perf_counter()
        run(given, table, cruising_lane(road), torques)
        best = min(best, time.perf_counter() - begun)
    return f"{1e6 * best / len(moments):.2g} us a control step in compiled code"
