"""Whether a network's bracketed form says what its exact window says.

Nothing proves it (intention/bracket.py), so it is tried: drives of virtual drivers whom
the network has never met, half of them manual, half with guidance and the bracketed
form in the loop. Over the signals of each drive the exact window gives a verdict at
every sample, too. If no side differs, the exact window in the loop would have driven
the same drive, sample by sample from the first.

A wrong side needs all three states beyond the band on the wrong side of 0.5. How far
they went there, as a share of the way to the band, is the margin.
"""

from __future__ import annotations

import math
import tempfile
from collections.abc import Callable
from functools import partial, reduce
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.drivers.population import POPULATION_VERSION
from costeer.intention.bracket import watched
from costeer.intention.checked import FACT, FEWEST_KILOMETRES
from costeer.intention.features import FEATURES, HEAD_YAW, SAMPLE_RATE, hide
from costeer.intention.gru import NetworkWeights
from costeer.intention.starts import Band, BracketWeights, bracket_weights
from costeer.intention.wavefront import crossing_probabilities
from costeer.intention.weights import (
    IntentionNetwork,
    intention_network,
    save_weights,
)
from costeer.loop.scenario import TrialSetup
from costeer.scale.jobs import JobsStoppedError, run_jobs
from costeer.training.simulation import FIRST_UNSEEN, manual_setup, recorded
from costeer.training.triggers import TriggerParameters, onsets

FIRST_CHECKED = FIRST_UNSEEN + 100_000
"""Number of the first driver who checks."""

BAND = Band(low=0.005, high=0.99)
"""That is checked. Source: chosen on seed 90001, see docs/decisions/0018-bracket.md."""

CHECK_SEED = 90_003
"""Of these drivers and of all noise: of nothing else."""

DRIVE = 8.0
"""Length of a drive [km]."""

SPARE = 1.01
"""Drives end at the end of the course, a few before [-]. Source: assumed."""

HEADLESS = 8
"""Of so many drives one is checked without head once more [-]."""

ASSISTED = ((1.0, 4.0), (1.0, 6.0), (1.0, 8.0), (0.4, 4.0), (0.4, 6.0), (0.4, 8.0))
"""Strength factor [-] and duration of a lane change [s], in turn."""

_VELOCITY = FEATURES.index("longitudinal_velocity")
_TRIGGER = TriggerParameters(merge=0.0)


class Tally(NamedTuple):
    """What was seen; sums but for the margin.

    Attributes:
        drives: How many.
        kilometres: Driven [km].
        assisted_kilometres: Of these with guidance [km].
        headless_kilometres: Driven once more without head, not among the others [km].
        verdicts: That both forms gave.
        triggers: Of the exact window.
        exact: Verdicts for which the bracketed form asked the exact window.
        wrong: Verdicts on another side of 0.5, or given by one form alone.
        margin: How far the three states went on the wrong side, as a share of the way
            to the band [-].
    """

    drives: int = 0
    kilometres: float = 0.0
    assisted_kilometres: float = 0.0
    headless_kilometres: float = 0.0
    verdicts: int = 0
    triggers: int = 0
    exact: int = 0
    wrong: int = 0
    margin: float = 0.0


_ASSUMED = Tally(kilometres=FEWEST_KILOMETRES)


def joined(one: Tally, other: Tally) -> Tally:
    """Both together."""
    sums: list[Any] = [a + b for a, b in zip(one, other, strict=True)]  # Any: numbers
    return Tally(*sums)._replace(margin=max(one.margin, other.margin))


def assisted_setup(place: int, seed: int, weights: Path) -> TrialSetup:
    """A trial with guidance.

    Args:
        place: Of the driver, which picks the condition.
        seed: Of the population and of all noise.
        weights: File of the network, which says that it has passed.
    """
    strength, duration = ASSISTED[place % len(ASSISTED)]
    return TrialSetup(
        participant=FIRST_CHECKED + place,
        seed=seed,
        condition=f"{'strong' if strength == 1.0 else 'weak'}-{duration:g}s",
        strength_factor=strength,
        change_duration=duration,
        weights=str(weights),
    )


def check_setup(place: int, seed: int, weights: Path) -> TrialSetup:
    """The drive at a place: manual at even ones, with guidance at odd ones."""
    if place % 2:
        return assisted_setup(place // 2, seed, weights)
    return manual_setup(FIRST_CHECKED + place // 2, seed, place // 2)


def compared(
    weights: NetworkWeights, packed: BracketWeights, features: NDArray[np.float64]
) -> Tally:
    """Both forms over one recording, its kilometres not told.

    Args:
        weights: The network.
        packed: The same with its band.
        features: Facing right, NaN where missing, `(time, feature)`.
    """
    exact = crossing_probabilities(weights, features)
    said = watched(packed, features)
    known = np.isfinite(exact)
    yes = exact >= _TRIGGER.threshold
    one_alone = known != np.isfinite(said.probability)
    wrong = one_alone | (known & (yes != (said.probability >= _TRIGGER.threshold)))
    too_low = np.where(known & yes, said.most / packed.low, 0.0)
    too_high = np.where(known & ~yes, said.least / packed.high, 0.0)
    return Tally(
        verdicts=int(known.sum()),
        triggers=len(onsets(exact, _TRIGGER)),
        exact=int(said.exact.sum()),
        wrong=int(wrong.sum()),
        margin=max(0.0, float(too_low.max()), float(too_high.max())),
    )


def checked_drive(
    network: IntentionNetwork, file: Path, seed: int, place: int
) -> Tally:
    """One drive, judged.

    Args:
        network: The network.
        file: Of the same network, for the loop.
        seed: Of the population and of all noise.
        place: Of the drive.
    """
    packed = bracket_weights(network.weights, BAND)
    found = Tally(drives=1)
    for each in recorded(check_setup(place, seed, file)):
        km = float(each.features[:, _VELOCITY].sum()) / SAMPLE_RATE / 1000.0
        told = Tally(kilometres=km, assisted_kilometres=km * (place % 2))
        both = compared(network.weights, packed, each.features)
        found = joined(found, joined(told, both))
        if place // 2 % HEADLESS == 0 and network.weights.dispensable[HEAD_YAW]:
            blind = hide(each.features, ("head_yaw",))
            both = compared(network.weights, packed, blind)
            found = joined(found, both._replace(headless_kilometres=km))
    return found


def checked_drives(
    network: IntentionNetwork,
    places: range,
    seed: int,
    jobs: int,
    progress: Callable[[int], None] | None = None,
) -> Tally:
    """Drives of other drivers than the network was trained, chosen or judged with.

    Args:
        network: Trained.
        places: Of the drives; those of one seed are told apart by them.
        seed: Of the population and of all noise.
        jobs: Threads.
        progress: Told after each drive.
    """

    def told(_: Tally) -> None:
        if progress:
            progress(1)

    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "network.npz"
        # The loop is to use the form that is checked, so this file says that it may.
        save_weights(file, with_check(network, _ASSUMED, seed))
        drive = partial(checked_drive, network, file, seed)
        try:
            return reduce(joined, run_jobs(drive, places, jobs, told), Tally())
        except JobsStoppedError as stopped:
            raise (stopped.__cause__ or stopped) from None


def num_drives(kilometres: float) -> int:
    """Drives that give so many kilometres [km], as many manual as with guidance."""
    return 2 * math.ceil(SPARE * kilometres / (2.0 * DRIVE))


def with_check(network: IntentionNetwork, found: Tally, seed: int) -> IntentionNetwork:
    """The network with its check among its facts.

    `intention.checked.has_passed` says what that is worth.

    Args:
        network: That was checked.
        found: What was seen.
        seed: Of the drives.
    """
    fact = {
        "hash": network.hash,
        "population": POPULATION_VERSION,
        "seed": seed,
        **BAND._asdict(),
        **found._asdict(),
    }
    return intention_network(network.weights, network.facts | {FACT: fact})
