"""What adapting to people gives, beside rivals that are adapted in the same way.

    python -m benchmarks.adaptation --data FOLDER [--folds 8] [SET ...]

FOLDER holds the sets of docs/datasets.md. Every row is judged on drivers (vehicles,
scenarios, days) without whom it was made: up to eight (`--folds`) left out one by one,
more in as many groups. "As it ships" learned from virtual drivers and triggers at 0.5.
All others have temperature, bias and a threshold for 0.05 false triggers per km from
the other drivers of the set. Intervals are 95 % by resampling drivers. Needs the extra
`train`; ten minutes a set.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.real_lane_changes import fitted_to_people
from costeer.intention.gru import NetworkWeights
from costeer.intention.predictors.gru import our_probabilities
from costeer.intention.predictors.interface import Probabilities, lacking
from costeer.intention.predictors.registry import predictor
from costeer.intention.weights import load_weights
from costeer.training.adapt import Heard, beside, heard, unmet
from costeer.training.adaptation import (
    DEFAULTS,
    AdaptationParameters,
    held_out,
    threshold_at_rate,
)
from costeer.training.calibration import (
    Calibration,
    calibrated,
    fit_calibration,
    logit,
)
from costeer.training.datasets.catalogue import read_dataset
from costeer.training.left_out import Parts, dealt, parts
from costeer.training.recordings import Recording
from costeer.training.verdicts import (
    DriverVerdicts,
    judged_samples,
    verdicts,
)

SETS = ("ngsim_lc", "ngsim_commonroad", "r3_driving", "brain4cars_head")
SEED = 1

Learner = Callable[[list[Recording]], Probabilities]

ADAPTED = "network, adapted"
HEADER = (
    "| predictor | PR-AUC (95 %) | minus the adapted network's | log loss | false/km "
    "| median lead [s] | missed |"
)


def rows(
    network: NetworkWeights,
    whole: Parts,
    parameters: AdaptationParameters = DEFAULTS,
) -> dict[str, list[Heard]]:
    """What each predictor says of those who were left out, the adapted network first.

    Args:
        network: As it ships.
        whole: Recordings of people, all with the same signals.
        parameters: Of the adaptation.
    """
    ours = asked_once(partial(our_probabilities, network))
    found = {
        ADAPTED: _network(network, whole, parameters),
        "network, calibrated only": rival(lambda _: ours, whole, parameters),
        "network as it ships": as_it_is(ours, whole, parameters),
    }
    line = predictor("line-time")
    if not lacking(line, whole.recordings[0].absent):
        found |= {
            "time to the line as it ships": as_it_is(
                line.probabilities, whole, parameters
            ),
            "time to the line, adapted": rival(
                lambda _: line.probabilities, whole, parameters
            ),
        }
    found["logistic regression of people"] = rival(fitted_to_people, whole, parameters)
    return found


def asked_once(predict: Probabilities) -> Probabilities:
    """The same predictor, which remembers what it said of each recording."""
    known: dict[int, tuple[NDArray[np.float64], NDArray[np.float64]]] = {}

    def probabilities(
        features: NDArray[np.float64], absent: tuple[str, ...] = ()
    ) -> NDArray[np.float64]:
        if id(features) not in known:
            known[id(features)] = features, predict(features, absent)
        return known[id(features)][1]

    return probabilities


def as_it_is(
    predict: Probabilities, whole: Parts, parameters: AdaptationParameters
) -> list[Heard]:
    """A predictor that learned nothing from these people, at 0.5."""
    return heard(verdicts(predict, whole.recordings), 0.5, parameters)


def _network(
    network: NetworkWeights, whole: Parts, parameters: AdaptationParameters
) -> list[Heard]:
    held = held_out(network, whole, SEED, parameters)
    return in_order([each for one in held for each in unmet(one, parameters)])


def in_order(found: list[Heard]) -> list[Heard]:
    """Drivers by name, as `verdicts` has them."""
    return sorted(found, key=lambda each: each.verdicts.driver)


def rival(
    learn: Learner, whole: Parts, parameters: AdaptationParameters
) -> list[Heard]:
    """A predictor of the other drivers, calibrated and with a threshold like ours."""
    found = []
    for training, judging in dealt(whole, parameters.outer_folds, SEED):
        inner = dealt(parts(training), parameters.inner_folds, SEED)
        unmet_said = [one for few, out in inner for one in verdicts(learn(few), out)]
        said, truth = judged_samples(unmet_said)
        calibration = fit_calibration(logit(said), truth, np.ones(len(said)))
        threshold = threshold_at_rate(
            [_calibrated(calibration, each) for each in unmet_said], parameters
        )
        speaks = verdicts(learn(training), judging)
        found += heard(
            [_calibrated(calibration, each) for each in speaks], threshold, parameters
        )
    return in_order(found)


def _calibrated(calibration: Calibration, one: DriverVerdicts) -> DriverVerdicts:
    return one._replace(
        probabilities=[calibrated(calibration, each) for each in one.probabilities]
    )


def told(value: float, ends: Sequence[float] | None, digits: int) -> str:
    """A number with its interval."""
    within = f" ({ends[0]:.{digits}f} to {ends[1]:.{digits}f})" if ends else ""
    return f"{value:.{digits}f}{within}"


def difference(first: dict[str, Any], one: dict[str, Any]) -> str:
    """Area under precision and recall against the adapted network's, in words."""
    ends = one.get(f"minus_{ADAPTED}_interval_95", {}).get("pr_auc")
    if ends is None:
        return ""
    word = "better" if ends[0] > 0.0 else "worse" if ends[1] < 0.0 else "undecided"
    value = one["pr_auc"] - first["pr_auc"]
    return f"{value:+.3f} ({ends[0]:+.3f} to {ends[1]:+.3f}), {word}"


def row(name: str, found: dict[str, Any]) -> str:
    """One predictor as a row of a Markdown table."""
    one = found[name]
    ends = one.get("interval_95", {})
    cells = [
        name,
        told(one["pr_auc"], ends.get("pr_auc"), 3),
        difference(found[ADAPTED], one),
        told(one["log_loss"], ends.get("log_loss"), 3),
        told(one["false_per_km"], ends.get("false_per_km"), 2),
        told(one["lead_time_median"], ends.get("lead_time_median"), 2),
        f"{one['missed']:.0f} of {one['num_crossings']:.0f}",
    ]
    return "| " + " | ".join(cells) + " |"


def main() -> None:
    """Print a table for each set."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--data", type=Path, required=True)
    parser.add_argument("--folds", type=int, default=DEFAULTS.outer_folds)
    parser.add_argument("sets", nargs="*", default=SETS)
    arguments = parser.parse_args()
    network = load_weights()
    parameters = DEFAULTS._replace(outer_folds=arguments.folds)
    print(f"Network {network.hash[:12]}, seed {SEED}")
    for name in arguments.sets:
        whole = parts(read_dataset(name, arguments.data))
        found = beside(rows(network.weights, whole, parameters), whole.kind)
        one = found[ADAPTED]
        print(
            f"\n{name}: {len(whole.names)} {whole.kind}, {one['kilometres']:.0f} km of "
            f"runs, {one['num_crossings']:.0f} crossings, prevalence "
            f"{one['prevalence']:.3f}; {found['intervals']}"
        )
        print(HEADER)
        print("|---" * (HEADER.count(" | ") + 1) + "|")
        for each in found:
            if each not in ("kind", "intervals"):
                print(row(each, found), flush=True)


if __name__ == "__main__":
    main()
