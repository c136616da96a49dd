"""Many trials at once: those that fit are driven eight at a time, the others alone.

A record does not depend on it by a bit; only the time does. What is driven together are
the paper's method and manual driving, virtual drivers of any parameters, on a road
without other cars, when nothing goes wrong on purpose.
"""

from __future__ import annotations

import threading
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.base.entry import entry_for
from costeer.base.lanes import WIDTH
from costeer.base.packing import layout_of, packed, unpack, unpack_lanes
from costeer.drivers.interface import DriverLaw, DriverNoise
from costeer.drivers.population import VIRTUAL
from costeer.intention.predictors.chosen import ChosenPredictor
from costeer.loop.lanes import SHARED, Block, joined, own, run_block, stacked
from costeer.loop.network import trial_network
from costeer.loop.noise import draw_noise
from costeer.loop.parameters import Bare, LoopParameters, bare_of, without
from costeer.loop.rollout import on_bare_road, row_width
from costeer.loop.rows import LoopRule, loop_rule, rules_of
from costeer.loop.scenario import (
    TrialSetup,
    loop_parameters,
    trial_driver_model,
    trial_method,
)
from costeer.loop.step import Rules, initial_state
from costeer.loop.tick import Network, Script
from costeer.loop.trial import (
    likely_steps,
    record_of,
    simulate_trial,
    slowest_steps,
    trial_predictor,
    trial_script,
)
from costeer.methods.ibhs import IBHS
from costeer.methods.interface import Method, Rule, compiled_once
from costeer.methods.manual import MANUAL
from costeer.records.columns import TrialRecord

LEAST = 3
"""Fewer trials are not worth a block of eight."""

_BARE = Bare(fleet=True, mistakes=True)

Rows = NDArray[np.float64]


class _Prepared(NamedTuple):
    """A trial before it is driven, and its place among those that were given."""

    place: int
    setup: TrialSetup
    parameters: LoopParameters[Any]
    predictor: ChosenPredictor | None


def simulate_together(
    setups: Sequence[TrialSetup],
) -> list[TrialRecord | Exception]:
    """Run trials, eight at a time where they fit together.

    Args:
        setups: What the trials are.

    Returns:
        For each its record, bit for bit that of `simulate_trial`, or what that would
        have raised.
    """
    found: dict[int, TrialRecord | Exception] = {}
    groups: dict[Any, list[_Prepared]] = {}
    for place, setup in enumerate(setups):
        try:
            parameters, predictor = loop_parameters(setup), trial_predictor(setup)
            each = _Prepared(place, setup, parameters, predictor)
            groups.setdefault(_fits(each), []).append(each)
        except Exception as error:  # of this trial alone
            found[place] = error
    for kind, group in groups.items():
        for first in range(0, len(group), WIDTH):
            block = group[first : first + WIDTH]
            alone = kind is None or len(block) < LEAST
            found |= _one_by_one(block) if alone else _driven_together(block)
    return [found[place] for place in range(len(setups))]


def _fits(each: _Prepared) -> Any:  # Any: what trials of a block have in common
    """What trials that are driven together have in common; None for one that is not."""
    setup, parameters, predictor = each.setup, each.parameters, each.predictor
    ours = trial_method(setup) in (IBHS, MANUAL)
    asks = predictor is not None and predictor.judge is not None
    if (
        not ours
        or asks
        or bare_of(parameters) != _BARE
        or trial_driver_model(setup) is not VIRTUAL
    ):
        return None
    shared = tuple(packed(getattr(parameters, name)).tobytes() for name in SHARED)
    script, network = trial_script(setup), trial_network(setup, parameters, predictor)
    told = script.intention, script.horizon, tuple(script.trigger_times.tolist())
    return shared, told, id(network.weights), _kind(parameters)


def _kind(value: Any) -> Any:  # Any: types and shapes, nested as the value is
    """What of nested tuples decides how they lie packed."""
    if isinstance(value, tuple):
        return type(value), *map(_kind, value)
    return type(value), np.shape(value) if isinstance(value, np.ndarray) else ()


def _one_by_one(trials: Sequence[_Prepared]) -> dict[int, TrialRecord | Exception]:
    def outcome(setup: TrialSetup) -> TrialRecord | Exception:
        try:
            return simulate_trial(setup)
        except Exception as error:  # of this trial alone
            return error

    return {each.place: outcome(each.setup) for each in trials}


def _driven_together(
    trials: Sequence[_Prepared],
) -> dict[int, TrialRecord | Exception]:
    """Drive up to eight trials; lanes that are left over repeat the last one."""
    likely = max(likely_steps(each.setup, each.parameters) for each in trials)
    slowest = [slowest_steps(each.setup) for each in trials]
    for steps in (likely, max(slowest)):
        block = _run([*trials, *[trials[-1]] * (WIDTH - len(trials))], steps)
        if block.counts.all():
            break
    counts = np.where(block.counts > 0, block.counts, steps)[: len(trials)]
    done = zip(trials, block.rows, np.minimum(counts, slowest), strict=False)
    # A copy, because the next block fills the same rows.
    return {
        each.place: _record(each, rows[:, :count].copy().T)
        for each, rows, count in done
    }


def _record(trial: _Prepared, rows: Rows) -> TrialRecord | Exception:
    try:
        return record_of(trial.setup, trial.parameters, trial.predictor, rows)
    except Exception as error:  # of this trial alone
        return error


def _run(trials: Sequence[_Prepared], steps: int) -> Block:
    """Run a block for at most so many steps."""
    method, rules = IBHS, rules_of(IBHS)
    all_of = [each.parameters for each in trials]
    lean = [without(parameters, _BARE) for parameters in all_of]
    states = [on_bare_road(initial_state(rules, parameters)) for parameters in all_of]
    shapes = (
        (WIDTH, len(DriverNoise._fields), steps),
        (WIDTH, row_width(method, all_of[0]), steps),
    )
    noise, rows = (_room(name, shape) for name, shape in zip("nr", shapes, strict=True))
    for lane, each in enumerate(trials):
        setup = each.setup
        draw_noise(setup.seed, setup.participant, setup.condition, noise[lane])
    block = Block(
        parameters=np.stack([packed(own(each)) for each in lean], axis=1),
        state=np.stack([packed(each) for each in states], axis=1),
        noise=noise,
        rows=rows,
        counts=np.zeros(WIDTH, np.int64),
    )
    networks = [trial_network(t.setup, t.parameters, t.predictor) for t in trials]
    run = compiled_once(_compiled_block, method, layout_of(lean[0]))
    run(packed(lean[0]), block, trial_script(trials[0].setup), stacked(networks))
    return block


_THREAD = threading.local()


def _room(name: str, shape: tuple[int, ...]) -> Rows:
    """An array that this thread uses again: new memory costs time to be filled."""
    there: Rows | None = getattr(_THREAD, name, None)
    size = int(np.prod(shape))
    if there is None or there.size < size:
        there = np.empty(size)
        setattr(_THREAD, name, there)
    return there[:size].reshape(shape)


def _compiled_block(method: Method[Any, Any]) -> Any:  # Any: a function of Numba
    """The compiled block; its machine code is kept as that of single trials is."""
    ((begin, step), (sit, act)), fill = loop_rule(method, VIRTUAL)
    usual = loop_parameters(TrialSetup())
    like = without(usual, _BARE)
    each = own(like)
    start = on_bare_road(initial_state(rules_of(method), usual))

    def run_packed(
        shared: Rows, block: Block, script: Script, network: Network
    ) -> None:
        # A tuple of functions is made in compiled code: Numba cannot take one.
        loop = LoopRule(Rules(Rule(begin, step), DriverLaw(sit, act)), fill)
        given = joined(unpack_lanes(each, block.parameters), unpack(like, shared))
        state = unpack_lanes(start, block.state)
        run_block(loop, given, state, script, network, block)

    return entry_for((begin, step, sit, act), run_packed)
