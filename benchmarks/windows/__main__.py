r"""Cheaper forms of the exact window: their cost, and what they change.

    python -m benchmarks.windows                         # 320 km, find the gate
    python -m benchmarks.windows --assisted
    python -m benchmarks.windows --drivers 1260 --seed 75001 --gates 0.005 \
        --brief --jobs 2                                         # 10,000 km
    python -m benchmarks.windows --cost-only   # a minute, on a quiet core

Simulates trials of 8 km of drivers of its own, asks every form for a verdict at every
sample, and prints what it costs, how far it is from the exact window and which triggers
differ. Manual trials are those that networks are trained on, with other drivers: all
suggested speeds, much wander, abandoned lane changes. A gate found with one seed is
tested with another. Time is that of the thread, so other processes disturb it little.
`--brief` leaves out the strided windows that are no candidates for the watcher.
The cost at other hidden sizes is that of the same network with idle units added.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from benchmarks.speed.machine import load, processor_name
from benchmarks.windows.agreement import Agreement, agreement, joined, percentile
from benchmarks.windows.forms import GATES, STRIDES, WATCHER, Form, enlarged, forms
from costeer.intention.features import FEATURES, SAMPLE_RATE
from costeer.intention.gru import NetworkWeights, hidden_size
from costeer.intention.weights import load_weights
from costeer.loop.scenario import TrialSetup
from costeer.training.simulation import (
    FIRST_UNSEEN,
    simulate_recordings,
    simulate_setups,
)

SIZES = (8, 16, 24, 32, 64)
BLOCK = 40
FIRST = 200_001
ROUNDS = 5
WATCHED = (0.01, 0.02, 0.05, 0.1, 0.2)
ASSISTED = ((1.0, 4.0), (1.0, 6.0), (1.0, 8.0), (0.4, 4.0), (0.4, 6.0), (0.4, 8.0))
_VELOCITY = FEATURES.index("longitudinal_velocity")

Floats = NDArray[np.float64]


def assisted_setup(number: int, seed: int) -> TrialSetup:
    """A trial with guidance, the exact window in the loop; conditions in turn."""
    strength, duration = ASSISTED[number % len(ASSISTED)]
    return TrialSetup(
        participant=FIRST + number,
        seed=seed,
        condition=f"{'strong' if strength == 1.0 else 'weak'}-{duration:g}s",
        strength_factor=strength,
        change_duration=duration,
    )


def blocks(options: argparse.Namespace) -> Iterator[list[Floats]]:
    """Features of trials, some at a time; each block has a seed of its own."""
    for start in range(0, options.drivers, BLOCK):
        wanted = min(BLOCK, options.drivers - start)
        seed = options.seed + start // BLOCK
        if options.assisted:
            setups = [assisted_setup(start + i, seed) for i in range(wanted)]
            own = simulate_setups(setups, options.jobs)
        else:
            own = simulate_recordings(wanted, seed, options.jobs, None, FIRST_UNSEEN)
        yield [recording.features for recording in own]


def timed(form: Form, features: Floats) -> tuple[Floats, float]:
    """Verdicts and the seconds of the thread that they took."""
    start = time.thread_time()
    verdicts = form.run(features)
    return verdicts, time.thread_time() - start


def warm_up(known: list[Form]) -> None:
    """Let everything be compiled before it is timed."""
    for form in known:
        form.run(np.zeros((400, len(FEATURES))))


def compare(known: list[Form], features: Floats) -> list[Agreement]:
    """Each form with the first, over one recording."""
    exact, seconds = timed(known[0], features)
    found = [agreement(exact, exact, seconds, WATCHED)]
    for form in known[1:]:
        verdicts, seconds = timed(form, features)
        found.append(agreement(exact, verdicts, seconds, WATCHED))
    return found


def merged(results: list[Agreement], found: list[Agreement]) -> list[Agreement]:
    """Results of all forms with those of more recordings."""
    if not results:
        return found
    return [joined(one, more) for one, more in zip(results, found, strict=True)]


def kilometres(series: list[Floats]) -> float:
    """Driven in these recordings [km]."""
    return float(sum(s[:, _VELOCITY].sum() for s in series)) / SAMPLE_RATE / 1000.0


def table(known: list[Form], results: list[Agreement], driven: float) -> None:
    """Print the forms."""
    print(
        "| form | us a tick | largest difference | 99.9 % | verdicts that differ, ppm "
        "| triggers missing, extra, shifted per 1000 km | samples that trigger "
        "differently | lowest where the exact one triggers |\n|" + "---|" * 8
    )
    for form, found in zip(known, results, strict=True):
        each = (found.missing, found.extra, found.shifted)
        rates = ", ".join(f"{1000.0 * n / driven:.3g}" for n in each)
        print(
            f"| {form.name} | {1e6 * found.seconds / found.ticks:.2f} "
            f"| {found.largest:.4f} | {percentile(found, 99.9):.4f} "
            f"| {1e6 * found.verdicts / found.samples:.3g} | {rates} "
            f"| {found.held} | {found.lowest:.4f} |"
        )


def watch_table(known: list[Form], results: list[Agreement]) -> None:
    """Print how often the watcher is above gates."""
    found = results[[form.name for form in known].index(WATCHER)]
    shares = found.stirred / found.samples
    told = ", ".join(
        f"{g:g}: {100 * s:.1f} %" for g, s in zip(WATCHED, shares, strict=True)
    )
    print(f"\nshare of samples where the watcher is at least at a gate: {told}")


def cost_table(weights: NetworkWeights, gate: float, features: Floats) -> None:
    """Print the cost by hidden size, median of some rounds over one recording."""
    sizes = [hidden_size(weights), *(h for h in SIZES if h > hidden_size(weights))]
    names = [form.name for form in forms(weights, (gate,))]
    print(
        "\nus a tick by hidden units (the same network with idle units added)\n\n"
        f"| form | {' | '.join(map(str, sizes))} |\n|" + "---|" * (len(sizes) + 1)
    )
    costs = [
        _costs(forms(enlarged(weights, size), (gate,)), features) for size in sizes
    ]
    for name, row in zip(names, zip(*costs, strict=True), strict=True):
        print(f"| {name} | {' | '.join(f'{value:.2f}' for value in row)} |")


def _costs(known: list[Form], features: Floats) -> list[float]:
    """Median microseconds a tick of each form."""
    warm_up(known)
    rounds = [[timed(form, features)[1] for form in known] for _ in range(ROUNDS)]
    return [float(m) for m in 1e6 * np.median(rounds, axis=0) / len(features)]


def run(options: argparse.Namespace, weights: NetworkWeights) -> None:
    """Simulate, compare and print; after each block a line of progress."""
    known = forms(weights, tuple(options.gates), () if options.brief else STRIDES)
    warm_up(known)
    results: list[Agreement] = []
    driven = 0.0
    for series in blocks(options):
        with ThreadPoolExecutor(options.jobs) as pool:
            for found in pool.map(partial(compare, known), series):
                results = merged(results, found)
        driven += kilometres(series)
        told = [f"{f.name} {r.held}" for f, r in zip(known, results, strict=True)]
        print(f"{driven:.0f} km; trigger differs: {', '.join(told[1:])}", flush=True)
    kind = "assisted" if options.assisted else "manual"
    print(
        f"\n{driven:.0f} {kind} km, {options.drivers} drivers, seed {options.seed}, "
        f"{results[0].samples} verdicts\n"
    )
    table(known, results, driven)
    watch_table(known, results)


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--drivers", type=int, default=BLOCK)
    parser.add_argument("--seed", type=int, default=71001)
    parser.add_argument("--gates", type=float, nargs="+", default=list(GATES))
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--brief", action="store_true")
    parser.add_argument("--assisted", action="store_true")
    parser.add_argument("--cost-only", action="store_true")
    parser.add_argument("--weights", type=Path, default=None)
    options = parser.parse_args()
    network = load_weights(options.weights)
    size = hidden_size(network.weights)
    print(
        f"{processor_name()}, load {load()}, network {network.hash[:12]}, {size} units"
    )
    if not options.cost_only:
        run(options, network.weights)
    (own, *_) = simulate_recordings(1, options.seed, first=FIRST_UNSEEN)
    features = own.features
    cost_table(network.weights, options.gates[-1], features)


if __name__ == "__main__":
    main()
