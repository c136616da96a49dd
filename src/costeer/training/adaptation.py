"""A network adapted to the people of one lab: fine-tuned, calibrated, with a threshold.

The recipe, on recordings of a few people and a few lane changes each:

1. The recordings are dealt to three parts by driver. From each two the network goes on
   learning for a few epochs, and is asked about the third. All three stop at the step
   at which what they say of the drivers they have not met is most telling: the lowest
   log loss after calibration. No step at all may be the best.
2. Temperature and bias are fitted to what was said at that step, of unmet drivers.
3. The threshold is the one that tells most at a stated rate of false triggers.
4. All recordings teach the network that is kept, as many steps.

The whole of it is done once more for each driver, without that driver, who judges the
result (`held_out`). So neither steps nor calibration nor threshold know who judges.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import cache, partial
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from numpy.typing import NDArray

from costeer.intention.features import WINDOW_LENGTH, network_inputs
from costeer.intention.gru import NetworkWeights
from costeer.intention.predictors.gru import our_probabilities
from costeer.training.calibration import (
    NEUTRAL,
    Calibration,
    calibrated_weights,
    fit_calibration,
)
from costeer.training.dataset import DatasetParameters, Windows, windows
from costeer.training.fit import FitParameters, descend
from costeer.training.left_out import Parts, dealt, num_changes, parts
from costeer.training.network import (
    TrainedWeights,
    logits,
    network_weights,
    trained_weights,
)
from costeer.training.operating import operating_counts, trigger_place
from costeer.training.recordings import Recording
from costeer.training.scaling import Scaling
from costeer.training.triggers import TriggerParameters
from costeer.training.tuning import DEFAULTS as TUNING
from costeer.training.verdicts import DriverVerdicts, verdicts

_CHUNK = 512
"""Windows that are asked about at once."""


FIT = TUNING._replace(
    batch_size=64, learning_rate=5e-4, num_steps=120, steps_per_check=20, patience=2
)
"""About three epochs of ten minutes of driving, at a tenth of the rate of a training.
Source: assumed."""


class AdaptationParameters(NamedTuple):
    """All that an adaptation depends on besides network, recordings and seed.

    Attributes:
        fit: How fast, how long at most, and how often it is looked whether to stop.
        dataset: Which windows are used.
        triggers: Debounce; its threshold is not used.
        false_per_km: Rate of false triggers that the threshold keeps to [1/km].
            Source: assumed, one false trigger in 20 km.
        calibrate: Whether temperature and bias are fitted [-]. Source: assumed.
        inner_folds: Parts by which steps, calibration and threshold are chosen [-].
            Source: assumed.
        outer_folds: Parts by which the result is judged, at most [-]. Source: assumed;
            up to so many drivers are left out one by one, more in so many groups.
        least_minutes: Of driving with verdicts [min]. Source: assumed; half of the
            lane changes of ten minutes on a motorway would still be two.
        least_changes: Lane changes [-]. Source: assumed; of three parts two teach.
    """

    fit: FitParameters = FIT
    dataset: DatasetParameters = DatasetParameters()
    triggers: TriggerParameters = TriggerParameters()
    false_per_km: float = 0.05
    calibrate: bool = True
    inner_folds: int = 3
    outer_folds: int = 8
    least_minutes: float = 10.0
    least_changes: int = 4


DEFAULTS = AdaptationParameters()


class Choice(NamedTuple):
    """What was chosen by drivers who had not been learned from.

    Attributes:
        steps: Of the training.
        calibration: Temperature and bias.
        threshold: A trigger begins here [-].
        curve: Step and log loss after calibration [nat] of each look.
        kind: What was left out, drivers or blocks.
    """

    steps: int
    calibration: Calibration
    threshold: float
    curve: list[tuple[int, float]]
    kind: str


class Adapted(NamedTuple):
    """A network and how it came about.

    Attributes:
        weights: Calibrated.
        choice: Steps, calibration and threshold.
    """

    weights: NetworkWeights
    choice: Choice


class HeldOut(NamedTuple):
    """A network and those who had no part in it.

    Attributes:
        adapted: To the others.
        recordings: To judge it on.
    """

    adapted: Adapted
    recordings: list[Recording]


def adapted(
    network: NetworkWeights,
    recordings: Sequence[Recording],
    seed: int,
    parameters: AdaptationParameters = DEFAULTS,
) -> Adapted:
    """The network as it suits the people of these recordings.

    Args:
        network: To start from; its scaling is kept.
        recordings: Of people; what they lack stays hidden.
        seed: Of the order of windows, and of who is dealt to which part.
        parameters: Everything else.

    Raises:
        ValueError: If the recordings do not suffice, or no threshold keeps to the rate.
    """
    whole = parts(recordings)
    if len(whole.names) < 2:
        raise ValueError(
            f"{sum(map(num_changes, recordings))} lane change(s) are left to learn "
            "from and to choose by; at least 2 are needed besides those that judge: "
            "record more"
        )
    choice = _choice(network, whole, seed, parameters)
    tuned = _tuned(network, recordings, seed, choice.steps, parameters)
    return Adapted(calibrated_weights(choice.calibration, tuned), choice)


def held_out(
    network: NetworkWeights,
    whole: Parts,
    seed: int,
    parameters: AdaptationParameters = DEFAULTS,
    progress: Callable[[int], None] = lambda _: None,
) -> Iterator[HeldOut]:
    """Networks adapted without a driver, or a block, and who was left out of each.

    Args:
        network: To start from.
        whole: Recordings with what is never split.
        seed: As for `adapted`.
        parameters: Everything else.
        progress: Told after each network that one more is done.
    """
    for others, judging in dealt(whole, parameters.outer_folds, seed):
        try:
            one = adapted(network, others, seed, parameters)
        except ValueError as error:
            out = ", ".join(sorted({each.driver for each in judging}))
            raise ValueError(f"without {out}: {error}") from error
        progress(1)
        yield HeldOut(one, judging)


def _choice(
    network: NetworkWeights,
    whole: Parts,
    seed: int,
    parameters: AdaptationParameters,
) -> Choice:
    """Steps, calibration and threshold, by parts that were not learned from."""
    folds = dealt(whole, parameters.inner_folds, seed)
    asked = [windows(out, parameters.dataset, needs_both=False) for _, out in folds]
    truth = np.concatenate([each.positive for each in asked]) > 0.5
    weight = np.concatenate([each.weight for each in asked]).astype(np.float64)
    lines = [
        _looks(network, training, data, seed, parameters)
        for (training, _), data in zip(folds, asked, strict=True)
    ]
    curve: list[tuple[int, float]] = []
    best: tuple[Calibration, list[NetworkWeights]] | None = None
    for place, states in enumerate(zip(*lines, strict=True)):
        said = np.concatenate([each for _, each in states])
        calibration = NEUTRAL
        if parameters.calibrate:
            calibration = fit_calibration(said, truth, weight)
        loss = _loss(calibration, said, truth, weight)
        if best is None or loss < min(each for _, each in curve):
            best = calibration, [weights for weights, _ in states]
        curve.append((place * parameters.fit.steps_per_check, loss))
        if _stalled(curve, parameters.fit.patience):
            break
    assert best is not None  # the look before the first step is always there
    steps = min(curve, key=lambda point: point[1])[0]
    heard = _heard(*best, [out for _, out in folds])
    threshold = threshold_at_rate(heard, parameters)
    return Choice(steps, best[0], threshold, curve, whole.kind)


def _heard(
    calibration: Calibration,
    networks: Sequence[NetworkWeights],
    parts_out: Sequence[list[Recording]],
) -> list[DriverVerdicts]:
    """What each network says, calibrated, of those whom it has not met."""
    return [
        each
        for weights, out in zip(networks, parts_out, strict=True)
        for each in verdicts(
            partial(our_probabilities, calibrated_weights(calibration, weights)), out
        )
    ]


def threshold_at_rate(
    drivers: Sequence[DriverVerdicts], parameters: AdaptationParameters
) -> float:
    """The threshold that tells most at the stated rate of false triggers.

    Raises:
        ValueError: If none keeps to the rate, naming the lowest.
    """
    counts = operating_counts(drivers, parameters.triggers)
    place = trigger_place(counts, parameters.false_per_km)
    if place is not None:
        return float(counts.thresholds[place])
    lowest = float((counts.false.sum(axis=1) / counts.kilometres.sum()).min())
    raise ValueError(
        f"no threshold keeps to {parameters.false_per_km:g} false triggers per km on "
        f"these {counts.kilometres.sum():.1f} km; the lowest rate is {lowest:.3g}: "
        "allow that many"
    )


def _looks(
    network: NetworkWeights,
    training: Sequence[Recording],
    asked: Windows,
    seed: int,
    parameters: AdaptationParameters,
) -> Iterator[tuple[NetworkWeights, NDArray[np.float64]]]:
    """The network before the first step and after every so many; and what it says."""
    scale, start = _scaling(network), trained_weights(network)
    yield network, _window_logits(start, asked, scale)
    data = windows(training, parameters.dataset)
    steps = descend(start, data, scale, seed, parameters.fit)
    for step in range(1, parameters.fit.num_steps + 1):
        weights, _ = next(steps)
        if step % parameters.fit.steps_per_check == 0:
            yield network_weights(weights, scale), _window_logits(weights, asked, scale)


def _tuned(
    network: NetworkWeights,
    recordings: Sequence[Recording],
    seed: int,
    num_steps: int,
    parameters: AdaptationParameters,
) -> NetworkWeights:
    """The network after some steps on these recordings; itself after none."""
    if num_steps == 0:
        return network
    scale = _scaling(network)
    data = windows(recordings, parameters.dataset)
    steps = descend(trained_weights(network), data, scale, seed, parameters.fit)
    for _ in range(num_steps):
        weights, _ = next(steps)
    return network_weights(weights, scale)


def _scaling(network: NetworkWeights) -> Scaling:
    return Scaling(network.feature_mean, network.feature_scale, network.dispensable)


@cache
def _compiled_logits() -> Callable[..., jax.Array]:
    return jax.jit(logits)


def _window_logits(
    weights: TrainedWeights, data: Windows, scale: Scaling
) -> NDArray[np.float64]:
    """Logits of all windows, in chunks of one size, so that one program serves."""
    back, found = np.arange(1 - WINDOW_LENGTH, 1), [np.empty(0)]
    for start in range(0, len(data.ends), _CHUNK):
        ends = data.ends[start : start + _CHUNK]
        filled = np.resize(ends, _CHUNK)
        seen = data.features[filled[:, None] + back]
        inputs = network_inputs(seen, scale.mean, scale.scale).astype(np.float32)
        said = _compiled_logits()(weights, jnp.asarray(inputs))
        found.append(np.asarray(said, np.float64)[: len(ends)])
    return np.concatenate(found)


def _loss(
    calibration: Calibration,
    said: NDArray[np.float64],
    truth: NDArray[np.bool_],
    weight: NDArray[np.float64],
) -> float:
    """Weighted log loss of calibrated logits [nat]."""
    turned = said / calibration.temperature + calibration.bias
    each = np.logaddexp(0.0, np.where(truth, -turned, turned))
    return float(np.average(each, weights=weight))


def _stalled(curve: Sequence[tuple[int, float]], patience: int) -> bool:
    """Whether the last looks brought nothing better."""
    place = int(np.argmin([loss for _, loss in curve]))
    return len(curve) - 1 - place >= patience
