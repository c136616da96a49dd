"""Temperature and bias: probabilities that mean what they say, in the same order.

The logit is divided by a temperature and a bias is added (Platt 1999; Guo et al. 2017
without the bias). Two numbers suit the few lane changes that a lab has; isotonic
regression would need hundreds, would make ties, and does not fit into a file of
weights, while these two are part of the network's last layer. The order of verdicts,
and so every area under a curve, stays.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float
from numpy.typing import NDArray
from scipy.optimize import minimize

from costeer.intention.gru import NetworkWeights, sigmoid

Numbers = NDArray[np.float64]

_CLOSEST = 1e-7
"""Probabilities are told from 0 and 1 down to this: the network computes in float32."""

_PENALTY = 1e-4
"""On the squares of log temperature and bias [nat]: perfect answers do not make the
temperature 0. Source: assumed, too small to be seen where both kinds are mixed."""


class Calibration(NamedTuple):
    """What is done to a logit.

    Attributes:
        temperature: It is divided by this [-]; above 1 it was too sure.
        bias: Added after that [-].
    """

    temperature: float = 1.0
    bias: float = 0.0


NEUTRAL = Calibration()


def logit(probability: Numbers) -> Numbers:
    """Of a probability, finite also at 0 and 1; NaN of NaN."""
    held = np.clip(probability, _CLOSEST, 1.0 - _CLOSEST)
    return np.asarray(np.log(held) - np.log1p(-held))


def calibrated(calibration: Calibration, probability: Numbers) -> Numbers:
    """Probabilities with the calibration; NaN stays."""
    turned = logit(probability) / calibration.temperature + calibration.bias
    return np.asarray(sigmoid(turned), np.float64)


def calibrated_weights(
    calibration: Calibration, weights: NetworkWeights
) -> NetworkWeights:
    """The network whose verdicts are calibrated; wherever it runs."""
    output = weights.output_weights / np.float32(calibration.temperature)
    bias = weights.output_bias / np.float32(calibration.temperature)
    return weights._replace(
        output_weights=output.astype(np.float32),
        output_bias=(bias + np.float32(calibration.bias)).astype(np.float32),
    )


def fit_calibration(
    logits: Float[Numbers, " sample"],
    positive: Bool[NDArray[np.bool_], " sample"],
    weight: Float[Numbers, " sample"],
) -> Calibration:
    """Temperature and bias of the lowest log loss; the temperature is positive.

    Args:
        logits: Of what was said by something that did not learn from these samples.
        positive: Truth.
        weight: How much each sample counts.
    """
    share = weight / weight.sum()

    def loss(numbers: Numbers) -> tuple[float, Numbers]:
        steepness = np.exp(numbers[0])
        turned = steepness * logits + numbers[1]
        each = np.logaddexp(0.0, turned) - positive * turned
        wrong = share * (np.asarray(sigmoid(turned)) - positive)
        slope = np.array([steepness * np.sum(wrong * logits), wrong.sum()])
        value = float(np.sum(share * each)) + _PENALTY * float(np.sum(numbers**2))
        return value, slope + 2.0 * _PENALTY * numbers

    bounds = [(-4.0, 4.0), (-20.0, 20.0)]
    found = minimize(loss, np.zeros(2), jac=True, method="L-BFGS-B", bounds=bounds)
    return Calibration(float(np.exp(-found.x[0])), float(found.x[1]))
