"""The control step and the network's verdict, called once in a while from Python."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from costeer.base.packing import pack
from costeer.bench.timing import (
    Effort,
    Figure,
    Outcome,
    Skipped,
    figure,
    percentiles,
    seconds_of,
)
from costeer.controller.realtime import ControlInput, control_step, packed_controller
from costeer.intention.features import NUM_FEATURES, IntentionSample
from costeer.intention.gru import NetworkWeights
from costeer.intention.wavefront import (
    advance,
    crossing_probabilities,
    initial_state,
    wavefront_weights,
)
from costeer.loop import step as loop
from costeer.loop.trial import shipped_network
from costeer.plant.road import cruising_lane

CONTROL_STEP_BUDGET = 20.0
"""99th percentile of a control step without the network [us]."""

_SAMPLES = 2_000


def measure_control_step(effort: Effort) -> Outcome:
    """Everything but the network, one packed float64 array in and one out."""
    parameters = loop.LoopParameters()
    lane = cruising_lane(parameters.road)
    memory = packed_controller(parameters.controller, lane)
    state = loop.initial_state(parameters)
    sample = loop.sense(parameters, state)
    pack(memory.given, ControlInput(sample, float("nan"), False))
    control_step(*memory, loop.DT)
    figures = percentiles(
        "control step",
        "control step",
        lambda: control_step(*memory, loop.DT),
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
    """One verdict of the exact window: inside compiled code, and from Python."""
    try:
        network = shipped_network()
    except (OSError, ValueError) as error:
        return [Skipped("network", "shipped network", str(error))]
    hidden = network.weights.output_weights.size
    remark = f"{hidden} hidden units, exact 180-sample window"
    seconds = verdict_seconds(network.weights, effort.rounds)
    packed = wavefront_weights(network.weights)
    memory, sample = initial_state(packed), IntentionSample(*([0.1] * NUM_FEATURES))
    advance(packed, memory, sample)
    return [
        figure("network", "verdict in compiled code", "us", 1e6 * seconds, remark),
        *percentiles(
            "network",
            "verdict from Python",
            lambda: advance(packed, memory, sample),
            effort._replace(calls=effort.calls // 4),
        ),
    ]


def verdict_seconds(weights: NetworkWeights, rounds: int) -> NDArray[np.float64]:
    """Time of one verdict when compiled code calls, as the closed loop does [s].

    Args:
        weights: Of the network.
        rounds: How often it is measured.
    """
    features = np.random.default_rng(0).normal(size=(_SAMPLES, NUM_FEATURES))
    crossing_probabilities(weights, features)
    times = seconds_of(lambda: crossing_probabilities(weights, features), rounds)
    return times / _SAMPLES
