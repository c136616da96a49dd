"""A trained network goes on learning from a few recordings: from simulation to people.

Few recordings of people hold few lane changes. A network that knows those of virtual
drivers learns from them what is different: a small rate, a fixed number of steps, the
scaling it came with.
"""

from __future__ import annotations

from collections.abc import Sequence

from costeer.intention.gru import NetworkWeights
from costeer.training.augmentation import ALL_SIGNALS
from costeer.training.dataset import DatasetParameters, windows
from costeer.training.fit import FitParameters, descend
from costeer.training.network import network_weights, trained_weights
from costeer.training.recordings import Recording
from costeer.training.scaling import Scaling

DATASET = DatasetParameters()

DEFAULTS = FitParameters(
    batch_size=256,
    learning_rate=1e-3,
    num_steps=400,
    augmentation=ALL_SIGNALS,
)
"""A fifth of the rate and a tenth of the steps of a training. Source: assumed."""


def fine_tuned(
    network: NetworkWeights,
    recordings: Sequence[Recording],
    seed: int,
    parameters: FitParameters = DEFAULTS,
    dataset: DatasetParameters = DATASET,
) -> NetworkWeights:
    """The network after some more steps, on these recordings only.

    Args:
        network: To start from; its scaling is kept.
        recordings: To learn from, of one kind: what they lack stays hidden.
        seed: Of the order of windows.
        parameters: How long and how fast.
        dataset: Which windows are used.

    Raises:
        ValueError: If the recordings hold no window, or windows of one class only.
    """
    scale = Scaling(
        mean=network.feature_mean,
        scale=network.feature_scale,
        dispensable=network.dispensable,
    )
    start = trained_weights(network)
    steps = descend(start, windows(recordings, dataset), scale, seed, parameters)
    for _, (weights, _) in zip(range(parameters.num_steps), steps, strict=False):
        last = weights
    return network_weights(last, scale)
