"""What a user waits for before anything runs: the help, and the first compilation."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile

from benchmarks.speed.timing import FULL, Effort, Outcome, figure, seconds_of

HELP_BUDGET = 0.5
"""Wall time of `costeer --help` [s]."""


_FIRST_TRIAL = (
    "from costeer.loop.scenario import TrialSetup\n"
    "from costeer.loop.trial import simulate_trial\n"
    "simulate_trial(TrialSetup(intention='off', length=100.0))\n"
)


def measure_start(effort: Effort) -> Outcome:
    """Start of the command line; with full effort also the first trial of all."""
    outcome = _help(effort)
    return [*outcome, *_first_trial()] if effort == FULL else outcome


def _help(effort: Effort) -> Outcome:
    """Wall time of `costeer --help` in a process of its own."""
    command = [sys.executable, "-m", "costeer", "--help"]
    times = seconds_of(
        lambda: subprocess.run(command, check=True, capture_output=True), effort.rounds
    )
    kept = "kept" if float(sorted(times)[len(times) // 2]) < HELP_BUDGET else "NOT kept"
    remark = f"budget {HELP_BUDGET:g} s: {kept}"
    return [figure("start", "costeer --help", "s", times, remark)]


def _first_trial() -> Outcome:
    """Wall time of a process that finds no machine code and makes it, once."""
    with tempfile.TemporaryDirectory() as empty:
        times = seconds_of(
            lambda: subprocess.run(
                [sys.executable, "-c", _FIRST_TRIAL],
                check=True,
                capture_output=True,
                env=os.environ | {"COSTEER_CACHE": empty},
            ),
            1,
        )
    remark = "compiles the closed loop, once for each version"
    return [figure("start", "first trial after installation", "s", times, remark)]
