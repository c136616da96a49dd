"""The network of a trial: which one runs in the loop, and in which form."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np

from costeer.base.described import described
from costeer.intention.features import NUM_FEATURES, NUM_INPUTS, NUM_SCALED
from costeer.intention.gru import NetworkWeights
from costeer.intention.predictors.chosen import ChosenPredictor, chosen_predictor
from costeer.intention.predictors.registry import OURS
from costeer.intention.starts import (
    OPEN,
    Band,
    BracketWeights,
    bracket_weights,
    initial_state,
)
from costeer.intention.weights import IntentionNetwork, load_weights
from costeer.loop.parameters import LoopParameters
from costeer.loop.scenario import TrialSetup, trial_method
from costeer.loop.tick import Network
from costeer.methods.ibhs import IBHS
from costeer.methods.manual import MANUAL
from costeer.methods.rivals import RIVALS

EXACT = "exact"
BRACKET = "bracket"
"""Forms of a network, see intention/bracket.py."""

_THRESHOLD = "inference.threshold"
_USUAL = 0.5


@cache
def shipped_network() -> IntentionNetwork:
    """The network that ships with costeer, read once."""
    return load_weights()


@cache
def idle_weights() -> BracketWeights:
    """Two units of zeros, for trials that ask no network."""
    units = 2
    return bracket_weights(
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


def _empty(weights: BracketWeights) -> Network:
    """A network that has seen nothing yet."""
    return Network(weights, initial_state(weights), initial_state(weights))


def idle_network() -> Network:
    """For trials that ask no network."""
    return _empty(idle_weights())


@cache
def _packed(
    digest: str, wanted: str, weights: str | None, band: Band
) -> BracketWeights:
    """Numbers of a network as the kernel takes them, made once for each `digest`."""
    chosen = chosen_predictor(wanted, weights).weights
    if chosen is None:
        raise ValueError(f"predictor {wanted} is no network")
    return bracket_weights(chosen, band)


def trial_predictor(setup: TrialSetup) -> ChosenPredictor | None:
    """The predictor that a trial asks; None for none.

    Raises:
        ValueError: If there is no such predictor, or its file does not fit.
        OSError: If its file cannot be read.
    """
    if setup.intention != "network":
        if setup.predictor != OURS or setup.weights is not None:
            raise ValueError(
                f"intention '{setup.intention}' asks no predictor; leave predictor and "
                "weights out, or choose intention network"
            )
        return None
    return chosen_predictor(setup.predictor, setup.weights)


def network_form(
    setup: TrialSetup,
    parameters: LoopParameters[Any],
    predictor: ChosenPredictor | None,
) -> str | None:
    """`EXACT` or `BRACKET`; None if no network runs in the loop.

    Bracketed verdicts have the right side of 0.5 and no more. So the form is exact
    where another threshold is set, and for methods that are not costeer's own, which
    may look at the number.
    """
    if predictor is None or predictor.weights is None:
        return None
    known = described(parameters)
    thresholds = [each.value for each in known if each.name.endswith(_THRESHOLD)]
    own = any(trial_method(setup) is each for each in (IBHS, MANUAL, *RIVALS))
    usual = all(value == _USUAL for value in thresholds)
    may = predictor.band is not None and own and usual and not setup.exact_network
    return BRACKET if may else EXACT


def trial_network(
    setup: TrialSetup,
    parameters: LoopParameters[Any],
    predictor: ChosenPredictor | None,
) -> Network:
    """The network of a trial, its memory empty, or an idle one."""
    form = network_form(setup, parameters, predictor)
    if form is None or predictor is None:
        return idle_network()
    checked = predictor.band if form == BRACKET else None
    band = OPEN if checked is None else checked
    packed = _packed(predictor.hash, str(setup.predictor), setup.weights, band)
    return _empty(packed)
