"""The control step and the network's verdict, called once in a while from Python."""

from __future__ import annotations

from benchmarks.speed.limit import measure_limit
from benchmarks.speed.timing import Effort, Figure, Outcome, Skipped, percentiles
from benchmarks.speed.verdicts import SIZES, measure_verdict
from costeer.base.packing import pack
from costeer.controller.realtime import ControlInput, control_step, packed_controller
from costeer.controller.signals import Request
from costeer.intention.gru import hidden_size, random_weights
from costeer.loop import step as loop
from costeer.loop.parameters import DT, LoopParameters
from costeer.loop.rows import rules_of
from costeer.loop.trial import shipped_network
from costeer.methods.ibhs import IBHS
from costeer.methods.interface import usual_parameters
from costeer.plant.road import cruising_lane

CONTROL_STEP_BUDGET = 20.0
"""99th percentile of a control step without the network [us]."""


def measure_control_step(effort: Effort) -> Outcome:
    """Everything but the network, one packed float64 array in and one out."""
    parameters = LoopParameters(controller=usual_parameters(IBHS))
    lane = cruising_lane(parameters.road)
    memory = packed_controller(parameters.controller, lane)
    state = loop.initial_state(rules_of(IBHS), parameters)
    pack(memory.given, ControlInput(loop.sense(parameters, state), Request()))
    control_step(*memory, DT)
    figures = percentiles(
        "control step",
        "control step",
        lambda: control_step(*memory, DT),
        effort,
    )
    remark = "all but the network, one packed array in and out"
    return [figures[0]._replace(remark=remark), *map(_against_budget, figures[1:])]


def _against_budget(found: Figure) -> Figure:
    """Say of the 99th percentile whether it keeps the budget."""
    if not found.name.endswith("p99"):
        return found
    kept = "kept" if found.median < CONTROL_STEP_BUDGET else "NOT kept"
    return found._replace(remark=f"budget {CONTROL_STEP_BUDGET:g} us: {kept}")


def measure_network(effort: Effort) -> Outcome:
    """One verdict of the exact window, by hidden size, beside what the core can do."""
    limit = measure_limit(effort)
    peak = 1e9 * limit[0].high
    networks = {f"{size} units": random_weights(size, 1) for size in SIZES}
    outcome: Outcome = list(limit)
    try:
        shipped = shipped_network().weights
        networks[f"shipped, {hidden_size(shipped)} units"] = shipped
    except (OSError, ValueError) as error:
        outcome.append(Skipped("network", "shipped network", str(error)))
    for name, weights in networks.items():
        outcome += measure_verdict(name, weights, peak, effort)
    return outcome
