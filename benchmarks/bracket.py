r"""Check the bracketed form of a network, and say what it saves in the loop.

    python -m benchmarks.bracket --kilometres 3000 --write FILE   # the check
    python -m benchmarks.bracket --loop 28      # drives bit for bit, driver-s/s
    python -m benchmarks.bracket --ticks        # single calls from Python

The check is that of `costeer train --check-kilometres` (training/bracket_check.py), for
weights that are there already, in parts; after each part a line and, with `--write`,
the weights with what is known so far among their facts. It goes on from what the facts
say of the same seed, so that a long check can be stopped. The loop compares trials with
the exact and the bracketed form of the same weights, which must have passed: every
column but the crossing probability, the side of that, and the time of the threads.
"""

from __future__ import annotations

import argparse
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.speed.machine import load, processor_name
from costeer.intention import bracket, wavefront
from costeer.intention.checked import FACT, shortcomings
from costeer.intention.features import IntentionSample
from costeer.intention.starts import OPEN, bracket_weights, initial_state
from costeer.intention.weights import IntentionNetwork, load_weights, save_weights
from costeer.loop.scenario import TrialSetup
from costeer.loop.trial import simulate_trial, trial_duration
from costeer.methods.conditions import CONDITION_NAMES
from costeer.records.columns import TrialRecord
from costeer.training.bracket_check import (
    BAND,
    CHECK_SEED,
    Tally,
    checked_drives,
    joined,
    num_drives,
    with_check,
)
from costeer.training.simulation import recorded

PART = 24
"""Drives between two lines."""

LOOP_SEED = 90_004
QUANTILES = (50, 99, 99.9, 100)
PROBABILITY = "crossing_probability"


def known(network: IntentionNetwork, seed: int) -> Tally:
    """What the facts say of drives with this seed."""
    fact = network.facts.get(FACT, {})
    wanted = {"hash": network.hash, "seed": seed, **BAND._asdict()}
    if any(fact.get(name) != value for name, value in wanted.items()):
        return Tally()
    return Tally(**{name: fact[name] for name in Tally._fields})


def line(found: Tally) -> str:
    """What was seen, in words."""
    return (
        f"{found.kilometres:.0f} km, {found.assisted_kilometres:.0f} of them assisted, "
        f"and {found.headless_kilometres:.0f} km without head: {found.verdicts} "
        f"verdicts, {found.triggers} triggers, exact share "
        f"{100.0 * found.exact / max(found.verdicts, 1):.2f} %, wrong {found.wrong}, "
        f"margin {100.0 * found.margin:.0f} %"
    )


def check(options: argparse.Namespace) -> None:
    """Drive, judge, print and write."""
    network = load_weights(options.weights)
    found, end = known(network, options.seed), num_drives(options.kilometres)
    while found.drives < end and not found.wrong:
        places = range(found.drives, min(found.drives + PART, end))
        found = joined(
            found, checked_drives(network, places, options.seed, options.jobs)
        )
        print(line(found), flush=True)
        if options.write:
            save_weights(options.write, with_check(network, found, options.seed))
    told = shortcomings(found._asdict())
    print("passed" if not told else f"not passed: {'; '.join(told)}")


def same(exact: TrialRecord, bracket: TrialRecord) -> bool:
    """Whether two drives are the same, bit for bit, but for the probability's number.

    Raises:
        ValueError: If the second is not of the bracketed form.
    """
    if bracket.metadata["network_form"] != "bracket":
        raise ValueError("these weights have not passed the check of their bracket")
    one, other = (
        np.ma.getdata(record.columns[PROBABILITY]) >= 0.5 for record in (exact, bracket)
    )
    return np.array_equal(one, other) and all(
        np.ma.getdata(values).tobytes()
        == np.ma.getdata(bracket.columns[name]).tobytes()
        for name, values in exact.columns.items()
        if name != PROBABILITY
    )


def in_loop(options: argparse.Namespace) -> None:
    """Trials of all conditions in three forms; print what differs and costs."""
    setups = [
        TrialSetup(
            participant=1 + i // len(CONDITION_NAMES),
            seed=LOOP_SEED,
            condition=CONDITION_NAMES[i % len(CONDITION_NAMES)],
            weights=None if options.weights is None else str(options.weights),
        )
        for i in range(options.loop)
    ]
    forms = {
        "exact": [each._replace(exact_network=True) for each in setups],
        "bracket": setups,
        "scripted": [
            each._replace(intention="scripted", weights=None) for each in setups
        ],
    }
    drives: dict[str, list[TrialRecord]] = {}
    for name, wanted in forms.items():
        simulate_trial(wanted[0]._replace(length=200.0))
        simulate_trial(wanted[-1]._replace(length=200.0))
        start = time.perf_counter(), time.process_time()
        with ThreadPoolExecutor(options.jobs) as pool:
            drives[name] = list(pool.map(simulate_trial, wanted))
        wall, own = time.perf_counter() - start[0], time.process_time() - start[1]
        seconds = sum(trial_duration(record) for record in drives[name])
        print(
            f"{name}: {seconds / wall:.0f} driver-s/s on {options.jobs} threads, "
            f"{1e6 * own / seconds:.0f} us of a core per driver-second"
        )
    pairs = zip(drives["exact"], drives["bracket"], strict=True)
    differ = sum(not same(*pair) for pair in pairs)
    print(f"{len(setups)} drives, exact and bracket: {differ} differ")


def ticks(options: argparse.Namespace) -> None:
    """Times of the thread of single calls over a drive with guidance; print them."""
    weights = load_weights(options.weights).weights
    setup = TrialSetup(seed=LOOP_SEED, condition=CONDITION_NAMES[1])
    (drive,) = recorded(setup)
    samples = [IntentionSample(*row) for row in drive.features]
    exact = wavefront.wavefront_weights(weights)
    # Any: each form has functions, weights and memory of its own.
    forms: dict[str, tuple[Any, Any, Any]] = {
        "180 states": (wavefront.advance, exact, wavefront.initial_state(exact))
    }
    for name, band in (
        ("all windows replayed", OPEN),
        (f"bracket {tuple(BAND)}", BAND),
    ):
        packed = bracket_weights(weights, band)
        forms[name] = (bracket.advance, packed, initial_state(packed))
    for name, (advance, packed, state) in forms.items():
        advance(packed, state, samples[0])
        times = np.empty(len(samples))
        for i, sample in enumerate(samples):
            start = time.thread_time_ns()
            advance(packed, state, sample)
            times[i] = 1e-3 * (time.thread_time_ns() - start)
        told = ", ".join(f"p{q:g} {np.percentile(times, q):.1f}" for q in QUANTILES)
        print(f"{name}: mean {times.mean():.1f} us, {told}")


def main() -> None:
    """Check, or compare in the loop."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--kilometres", type=float, default=0.0)
    parser.add_argument("--write", type=Path, default=None)
    parser.add_argument("--loop", type=int, default=0)
    parser.add_argument("--ticks", action="store_true")
    parser.add_argument("--seed", type=int, default=CHECK_SEED)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--weights", type=Path, default=None)
    options = parser.parse_args()
    print(f"{processor_name()}, load {load()}")
    if options.kilometres:
        check(options)
    if options.ticks:
        ticks(options)
    if options.loop:
        in_loop(options)


if __name__ == "__main__":
    main()
