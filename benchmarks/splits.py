"""Two ways to hold data back: other drivers, or later driving of the same ones.

The paper trained and tested on the same nine drivers: the last 30 minutes of three of
them test, one sixth of the rest validates, the rest trains. A network judged so has
met its judges. Under the split by driver the same minutes test, but of the three
drivers nothing else is used: three others, as many minutes of them and at the same
speeds, take their place in the training. So both networks are trained on as much and
judged on the same samples, and differ only in whether they have met the drivers.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from costeer.intention.features import SAMPLE_RATE
from costeer.intention.predictors.gru import paper_probabilities
from costeer.loop.scenario import TrialSetup
from costeer.training.augmentation import ALL_SIGNALS, dispensable
from costeer.training.dataset import DatasetParameters, Split, windows
from costeer.training.evaluate import EvaluationParameters, evaluate
from costeer.training.labels import labels
from costeer.training.recordings import Recording
from costeer.training.simulation import manual_setup, simulate_setups

FIRST_OF_PAPER = 400_001
"""Number of the first driver of this comparison, who is in nothing else."""


class PaperParameters(NamedTuple):
    """The paper's data and its split.

    Attributes:
        num_drivers: [-]. Source: paper, nine drivers.
        trials_per_driver: Of 8 km each [-]. Source: assumed, about 70 minutes, so that
            30 minutes can be held back.
        num_test_drivers: Whose last minutes test [-]. Source: paper, three.
        test_time: Held back at the end of their driving [s]. Source: paper, 30 min.
        validation_share: Of the rest [-]. Source: paper, one sixth.
        block: Length of the stretches that the rest is dealt in [s]. Source: assumed, a
            minute; a block holds whole lane changes.
        hidden_size: Of the network [-]. Source: assumed.
        num_steps: Of the training at most [-]. Source: assumed.
    """

    num_drivers: int = 9
    trials_per_driver: int = 10
    num_test_drivers: int = 3
    test_time: float = 1800.0
    validation_share: float = 1.0 / 6.0
    block: float = 60.0
    hidden_size: int = 16
    num_steps: int = 3000


PAPER = PaperParameters()


class PaperRecordings(NamedTuple):
    """Driving of the paper's experiment, and of those who stand in for test drivers.

    Attributes:
        drivers: All trials of the drivers, each driver's in the order driven.
        substitutes: As many trials of as many others as there are test drivers.
    """

    drivers: list[Recording]
    substitutes: list[Recording]


def test_places(parameters: PaperParameters, seed: int) -> list[int]:
    """Which drivers test, drawn by lot, ascending."""
    rng = np.random.default_rng([seed, 3])
    drawn = rng.permutation(parameters.num_drivers)[: parameters.num_test_drivers]
    return sorted(int(place) for place in drawn)


def paper_setups(parameters: PaperParameters, seed: int) -> list[TrialSetup]:
    """Trials of the drivers, then of the substitutes; each trial is another drive.

    A substitute has the speeds of the test driver in whose place he or she drives.
    """
    num = parameters.num_drivers
    places = [*range(num), *test_places(parameters, seed)]
    return [
        manual_setup(FIRST_OF_PAPER + number, seed, place, trial)
        for number, place in enumerate(places)
        for trial in range(1, parameters.trials_per_driver + 1)
    ]


def paper_recordings(
    parameters: PaperParameters,
    seed: int,
    jobs: int = 1,
    progress: Callable[[int], None] | None = None,
) -> PaperRecordings:
    """Simulate the paper's experiment.

    Args:
        parameters: How many drivers and trials.
        seed: Of drivers and noise.
        jobs: Threads.
        progress: Told after each trial.
    """
    found = simulate_setups(paper_setups(parameters, seed), jobs, progress)
    own = parameters.num_drivers * parameters.trials_per_driver
    return PaperRecordings(found[:own], found[own:])


def cut(recording: Recording, first: int, last: int) -> Recording:
    """Samples from `first` to before `last` as a recording of its own.

    What happens after the cut is not known to it: labels at its end are made anew, so
    that no label of one part looks into another.
    """
    part = slice(first, last)
    crossing, side = recording.crossing[part], recording.side[part]
    return recording._replace(
        name=f"{recording.name}, rows {first} to {last}",
        features=recording.features[part],
        side=side,
        crossing=crossing,
        intended=recording.intended[part],
        labels=labels(crossing, side),
    )


def last_minutes(
    recordings: Sequence[Recording], duration: float
) -> tuple[list[Recording], list[Recording]]:
    """Divide one driver's recordings, in the order driven, into the rest and the end.

    Args:
        recordings: Of one driver.
        duration: Of the end [s].

    Raises:
        ValueError: If they are not longer than that.
    """
    left = round(duration * SAMPLE_RATE)
    total = sum(len(one.side) for one in recordings)
    if total <= left:
        raise ValueError(
            f"the recordings of {recordings[0].driver} last {total / SAMPLE_RATE:.0f} "
            f"s, but {duration:g} s of them are to be held back; give more trials"
        )
    rest, end = [], []
    for one in reversed(recordings):
        length = len(one.side)
        start = max(0, length - left)
        left -= length - start
        if start < length:
            end.append(cut(one, start, length))
        if start > 0:
            rest.append(cut(one, 0, start))
    return rest[::-1], end[::-1]


def time_blocks(recording: Recording, duration: float) -> list[Recording]:
    """Cut a recording into equal stretches of about that length."""
    length, size = len(recording.side), round(duration * SAMPLE_RATE)
    num = max(1, round(length / size))
    edges = np.linspace(0, length, num + 1).astype(int)
    return [cut(recording, int(a), int(b)) for a, b in itertools.pairwise(edges)]


def split_by_time(
    parameters: PaperParameters, recordings: PaperRecordings, seed: int
) -> Split:
    """The paper's split: the same drivers train and test, at different times.

    Args:
        parameters: How much is held back, of whom.
        recordings: Of all drivers.
        seed: Of the lots for test drivers and validation blocks.

    Raises:
        ValueError: If a test driver drove too little.
    """
    others, tested = _parted(parameters, recordings.drivers, seed)
    parts = [last_minutes(own, parameters.test_time) for own in tested]
    rest = [one for before, _ in parts for one in before]
    test = [one for _, end in parts for one in end]
    return _dealt(parameters, [*others, *rest], test, seed)


def split_by_driver_alike(
    parameters: PaperParameters, recordings: PaperRecordings, seed: int
) -> Split:
    """The same test part, but nothing else of its drivers; others stand in for them.

    Args:
        parameters: How much is held back, of whom.
        recordings: Of all drivers, and of the substitutes.
        seed: Of the lots for test drivers and validation blocks.

    Raises:
        ValueError: If a test driver or a substitute drove too little.
    """
    others, tested = _parted(parameters, recordings.drivers, seed)
    ends = [last_minutes(own, parameters.test_time)[1] for own in tested]
    substitutes = _by_driver(recordings.substitutes)
    rest = [last_minutes(own, parameters.test_time)[0] for own in substitutes]
    return _dealt(
        parameters,
        [*others, *(one for own in rest for one in own)],
        [one for end in ends for one in end],
        seed,
    )


def _by_driver(recordings: Sequence[Recording]) -> list[list[Recording]]:
    """Recordings of each driver, in the order given."""
    found: dict[str, list[Recording]] = {}
    for one in recordings:
        found.setdefault(one.driver, []).append(one)
    return list(found.values())


def _parted(
    parameters: PaperParameters, recordings: Sequence[Recording], seed: int
) -> tuple[list[Recording], list[list[Recording]]]:
    """Recordings of the drivers who only train, and of each one who tests."""
    groups, places = _by_driver(recordings), test_places(parameters, seed)
    if len(groups) != parameters.num_drivers:
        raise ValueError(
            f"the recordings are of {len(groups)} driver(s), but the split is for "
            f"{parameters.num_drivers}; set num_drivers to what there is"
        )
    others = [one for i, own in enumerate(groups) if i not in places for one in own]
    return others, [groups[place] for place in places]


def _dealt(
    parameters: PaperParameters,
    rest: Sequence[Recording],
    test: list[Recording],
    seed: int,
) -> Split:
    """Deal blocks of the rest to training and validation."""
    blocks = [b for one in rest for b in time_blocks(one, parameters.block)]
    num = max(1, round(parameters.validation_share * len(blocks)))
    rng = np.random.default_rng([seed, 4])
    chosen = set(rng.permutation(len(blocks))[:num].tolist())
    return Split(
        training=[b for i, b in enumerate(blocks) if i not in chosen],
        validation=[blocks[i] for i in sorted(chosen)],
        test=test,
    )


def hours(recordings: Sequence[Recording]) -> float:
    """How long they are together [h]."""
    return sum(len(one.side) for one in recordings) / SAMPLE_RATE / 3600.0


def judge_split(parameters: PaperParameters, split: Split, seed: int) -> dict[str, Any]:
    """Train the paper's network on a split and judge it on the split's test part.

    Args:
        parameters: Size and length of the training.
        split: Into training, validation and test.
        seed: Of first weights and order.

    Returns:
        As `evaluate` does, with the hours of each part.
    """
    from costeer.training.fit import FitParameters, fit
    from costeer.training.scaling import scaling

    fitting = FitParameters(
        num_steps=parameters.num_steps,
        steps_per_check=max(1, min(500, parameters.num_steps // 4)),
        augmentation=ALL_SIGNALS,
    )
    scale = scaling(split.training, dispensable(ALL_SIGNALS))
    found = fit(
        windows(split.training, DatasetParameters()),
        scale,
        split.validation,
        parameters.hidden_size,
        seed,
        fitting,
    )
    predict = partial(paper_probabilities, found.weights)
    return {
        "hours_of_parts": {name: hours(part) for name, part in split._asdict().items()},
        "steps": found.best.step,
        **evaluate(predict, split.test, EvaluationParameters()),
    }


def compare_splits(
    parameters: PaperParameters, recordings: PaperRecordings, seed: int
) -> dict[str, dict[str, Any]]:
    """The paper's network under its split by time and under the split by driver.

    Args:
        parameters: Drivers, split and training.
        recordings: Of `paper_recordings`.
        seed: Of lots and weights.
    """
    splits = {
        "by time": split_by_time(parameters, recordings, seed),
        "by driver": split_by_driver_alike(parameters, recordings, seed),
    }
    return {n: judge_split(parameters, one, seed) for n, one in splits.items()}
