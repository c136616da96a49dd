"""Cheaper forms of the exact window, each as a function of one recording.

Strided windows begin only at every s-th sample, so that the verdict is that of a
window of 180 to 180 + s - 1 samples: 180/s states instead of 180. A carried state is
the end of that row. The cascade (cascade.py) opens exact windows where a
strided one stirs.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from benchmarks.windows import cascade, sparse
from benchmarks.windows.cascade import CascadeState, CascadeWeights, cascade_weights
from benchmarks.windows.sparse import NEVER, advance_few
from costeer.base.entry import entry
from costeer.intention.features import WINDOW_LENGTH, IntentionSample
from costeer.intention.gru import NetworkWeights, hidden_size
from costeer.intention.kernel import TILE
from costeer.intention.wavefront import (
    WavefrontState,
    WavefrontWeights,
    advance_states,
    crossing_probabilities,
    initial_state,
    project,
    take,
    verdict,
    wavefront_weights,
)

Floats = NDArray[np.float64]

STRIDES = (3, 6, 12)
"""Of strided windows in the layout of the wavefront [-]."""

GATES = (0.02, 0.05, 0.1, 0.2)
"""Of cascades [-]."""

EXACT = "exact window"
CARRIED = "one carried state"
WATCHER = f"start every {sparse.STRIDE} samples"


class Form(NamedTuple):
    """One way to a verdict.

    Attributes:
        name: For people.
        run: Verdict at every sample from features `(time, feature)`, `(time,)`.
    """

    name: str
    run: Callable[[Floats], Floats]


def forms(
    weights: NetworkWeights,
    gates: tuple[float, ...] = GATES,
    strides: tuple[int, ...] = STRIDES,
) -> list[Form]:
    """The exact window first, then the cheaper forms.

    Args:
        weights: The network.
        gates: Of the cascades [-].
        strides: Of strided windows in the layout of the wavefront [-].
    """
    few = partial(few_probabilities, weights)
    return [
        Form(EXACT, partial(crossing_probabilities, weights)),
        Form(CARRIED, partial(few, stride=NEVER)),
        *(
            Form(f"start every {s} samples", partial(strided, weights, stride=s))
            for s in strides
        ),
        Form(WATCHER, partial(few, stride=sparse.STRIDE)),
        *(
            Form(
                f"cascade, gate {gate:g}",
                partial(cascade.crossing_probabilities, cascade_weights(weights, gate)),
            )
            for gate in gates
        ),
    ]


def enlarged(weights: NetworkWeights, hidden: int) -> NetworkWeights:
    """The same network with more hidden units: same verdicts, more work.

    What is added has no weights, so it stays at rest.

    Raises:
        ValueError: If the network has more units already.
    """
    extra = hidden - hidden_size(weights)
    if extra < 0:
        raise ValueError(
            f"the network has {hidden_size(weights)} hidden units; give that or more, "
            f"not {hidden}"
        )

    def padded(values: NDArray[np.float32], *axes: int) -> NDArray[np.float32]:
        return np.pad(
            values, [(0, extra if axis in axes else 0) for axis in range(values.ndim)]
        )

    return weights._replace(
        input_weights=padded(weights.input_weights, 1),
        input_bias=padded(weights.input_bias, 1),
        hidden_weights=padded(weights.hidden_weights, 1, 2),
        hidden_bias=padded(weights.hidden_bias, 1),
        output_weights=padded(weights.output_weights, 0),
    )


def num_starts(stride: int) -> int:
    """Windows that are open when one begins at every `stride`-th sample."""
    return -(-(WINDOW_LENGTH + stride - 1) // stride)


@entry
def _strided_over(
    weights: WavefrontWeights,
    state: WavefrontState,
    features: Floats,
    stride: int,
    starts: int,
    probabilities: Floats,
) -> None:
    number = 0
    for step in range(features.shape[0]):
        row = features[step]
        sample = IntentionSample(row[0], row[1], row[2], row[3], row[4], row[5])
        probabilities[step] = math.nan
        if not take(weights, state, sample):
            number = 0
            continue
        lane = (number // stride) % starts
        if number % stride == 0:
            state.hidden[lane // TILE, :, lane % TILE] = 0.0
        project(weights, state)
        advance_states(weights, state)
        number += 1
        if number >= WINDOW_LENGTH:
            youngest = ((number - WINDOW_LENGTH) // stride) % starts
            probabilities[step] = verdict(weights, state, youngest)


def strided(weights: NetworkWeights, features: Floats, stride: int) -> Floats:
    """Verdicts of windows that begin at every `stride`-th sample, `(time,)`."""
    packed, starts = wavefront_weights(weights), num_starts(stride)
    probabilities = np.empty(len(features))
    state = initial_state(packed, num_lanes=starts)
    _strided_over(packed, state, features, stride, starts, probabilities)
    return probabilities


@entry
def _few_over(
    weights: CascadeWeights,
    state: CascadeState,
    features: Floats,
    stride: int,
    probabilities: Floats,
) -> None:
    number = 0
    for step in range(features.shape[0]):
        row = features[step]
        sample = IntentionSample(row[0], row[1], row[2], row[3], row[4], row[5])
        probabilities[step] = math.nan
        if not take(weights.exact, state.front, sample):
            number = 0
            continue
        project(weights.exact, state.front)
        probabilities[step] = advance_few(
            weights.watcher, state.watcher, state.front.projection, number, stride
        )
        number += 1


def few_probabilities(weights: NetworkWeights, features: Floats, stride: int) -> Floats:
    """Verdicts of the watcher alone, `(time,)`.

    Args:
        weights: The network.
        features: Of one recording, `(time, feature)`.
        stride: `sparse.STRIDE` or more; `sparse.NEVER` is a carried state.
    """
    packed = cascade_weights(weights)
    probabilities = np.empty(len(features))
    _few_over(packed, cascade.initial_state(packed), features, stride, probabilities)
    return probabilities
