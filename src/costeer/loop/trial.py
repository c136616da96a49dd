"""One trial from its setup to its record."""

from __future__ import annotations

import hashlib
import json
from functools import cache
from importlib import metadata as distribution
from typing import Any

import numpy as np

from costeer.base.array import Real
from costeer.drivers.population import POPULATION_VERSION
from costeer.intention.features import NUM_FEATURES, NUM_INPUTS, NUM_SCALED
from costeer.intention.gru import NetworkWeights
from costeer.intention.wavefront import (
    WavefrontWeights,
    wavefront_weights,
)
from costeer.intention.wavefront import initial_state as network_memory
from costeer.intention.weights import IntentionNetwork, load_weights
from costeer.loop.noise import driver_noise
from costeer.loop.rollout import Script, rollout
from costeer.loop.scenario import (
    INTENTIONS,
    TrialSetup,
    is_assisted,
    loop_parameters,
)
from costeer.loop.step import DT, LoopParameters
from costeer.records.columns import TrialRecord
from costeer.records.metadata import RECORD_VERSION
from costeer.records.row import record_columns

SLOWEST_SHARE = 0.5
"""A trial ends at the latest when a car at this share of its speed would arrive."""


@cache
def shipped_network() -> IntentionNetwork:
    """The network that ships with costeer, read once."""
    return load_weights()


@cache
def _shipped_weights() -> WavefrontWeights:
    """The shipped network as the kernel takes it."""
    return wavefront_weights(shipped_network().weights)


@cache
def idle_weights() -> WavefrontWeights:
    """Two units of zeros, for trials that ask no network."""
    units = 2
    return wavefront_weights(
        NetworkWeights(
            feature_mean=np.zeros(NUM_SCALED),
            feature_scale=np.ones(NUM_SCALED),
            dispensable=np.zeros(NUM_FEATURES),
            input_weights=np.zeros((3, units, NUM_INPUTS), np.float32),
            hidden_weights=np.zeros((3, units, units), np.float32),
            input_bias=np.zeros((3, units), np.float32),
            hidden_bias=np.zeros((3, units), np.float32),
            output_weights=np.zeros(units, np.float32),
            output_bias=np.zeros(1, np.float32),
        )
    )


def _predictor(
    setup: TrialSetup, network: IntentionNetwork | None
) -> tuple[WavefrontWeights, str | None]:
    """Packed weights of the network that a trial asks, and its hash."""
    if setup.intention != "network":
        return idle_weights(), None
    if network is not None:
        return wavefront_weights(network.weights), network.hash
    return _shipped_weights(), shipped_network().hash


def simulate_trial(
    setup: TrialSetup,
    engine: str = "numba",
    network: IntentionNetwork | None = None,
) -> TrialRecord:
    """Run one trial.

    Args:
        setup: What the trial is.
        engine: "numba", "python" or "jax"; all give the same numbers. JAX runs no
            network.
        network: Of the intention; the shipped one if None.

    Returns:
        Its record; the same setup and version give the same record.

    Raises:
        ValueError: If the setup cannot be run or the engine is not known.
        ModuleNotFoundError: If the engine is not installed.
    """
    parameters = loop_parameters(setup)
    packed, network_hash = _predictor(setup, network)
    longest = setup.length / (SLOWEST_SHARE * setup.speed)
    noise = driver_noise(
        setup.seed, setup.participant, setup.condition, int(np.ceil(longest / DT))
    )
    script = Script(
        intention=INTENTIONS[setup.intention],
        horizon=setup.prediction_horizon,
        trigger_times=np.array(sorted(setup.trigger_times), dtype=np.float64),
    )
    rows = rollout(parameters, script, packed, network_memory(packed), noise, engine)
    return TrialRecord(
        metadata=trial_metadata(setup, parameters, network_hash),
        columns=record_columns(rows, is_assisted(setup)),
    )


def trial_metadata(
    setup: TrialSetup, parameters: LoopParameters, network_hash: str | None
) -> dict[str, object]:
    """The record's description of the trial, spec section 6."""
    configuration = json.loads(json.dumps(_as_dict(parameters)))
    configuration["setup"] = _as_dict(setup)
    text = json.dumps(configuration, sort_keys=True)
    controller = parameters.controller
    return {
        "version": distribution.version("costeer"),
        "seed": setup.seed,
        "participant": setup.participant,
        "condition": setup.condition,
        "strength_factor": controller.actuation.strength_factor,
        "change_duration": setup.change_duration,
        "method": setup.method,
        "car": setup.car,
        "speed": setup.speed,
        "driver": f"{setup.driver}, population {POPULATION_VERSION}",
        "intention_model_hash": network_hash,
        "inconsistency_threshold": controller.consistency.inconsistency_threshold,
        "replan_gain": controller.replanning.replan_gain,
        "torque_limit": controller.actuation.torque_limit,
        "configuration": configuration,
        "configuration_hash": hashlib.sha256(text.encode()).hexdigest(),
        "driver_torque_source": "simulated",
        "git_revision": git_revision(),
        "driver_kind": setup.driver,
        "record_version": RECORD_VERSION,
    }


@cache
def git_revision() -> str | None:
    """Revision of the sources that run, None outside a checkout."""
    import subprocess
    from pathlib import Path

    command = ["git", "rev-parse", "HEAD"]
    folder = Path(__file__).parents[3]
    if not (folder / ".git").exists():
        return None
    try:
        answer = subprocess.run(
            command, cwd=folder, capture_output=True, text=True, check=True
        )
    except (OSError, subprocess.CalledProcessError):
        return None
    return answer.stdout.strip()


def _as_dict(value: Any) -> Any:  # Any: a tree of numbers, names and tuples
    """Nested named tuples as nested dictionaries; NaN, which JSON has not, as null."""
    if isinstance(value, tuple) and hasattr(value, "_fields"):
        return {name: _as_dict(getattr(value, name)) for name in value._fields}
    if isinstance(value, tuple):
        return [_as_dict(item) for item in value]
    if isinstance(value, float) and value != value:
        return None
    return value


def trial_duration(record: TrialRecord) -> Real:
    """How long a trial lasted [s]."""
    return float(len(record.columns["time"]) * DT)
