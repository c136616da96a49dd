"""Trials of a study by the batch: a large one is driven eight trials at a time."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

from costeer.base.lanes import WIDTH
from costeer.study.design import Trial
from costeer.study.trials import TrialDone

TOGETHER_FROM = 500
"""From so many trials on eight are driven at a time, which takes less time for each and
half a minute more of compiling. No number depends on it."""


class Work(NamedTuple):
    """How trials are finished; a worker elsewhere can do it.

    Attributes:
        one: Finishes one trial.
        several: Finishes trials together; None where they cannot be.
    """

    one: Callable[[Trial], TrialDone]
    several: Callable[[Sequence[Trial]], list[TrialDone]] | None = None

    def done(self, trials: Sequence[Trial]) -> list[TrialDone]:
        """Finish some trials."""
        if len(trials) == 1 or self.several is None:
            return [self.one(trial) for trial in trials]
        return self.several(trials)

    def batches(self, trials: Sequence[Trial]) -> list[Sequence[Trial]]:
        """The trials in batches: of one, or of as many as are driven together."""
        size = WIDTH if self.several and len(trials) >= TOGETHER_FROM else 1
        return [trials[first : first + size] for first in range(0, len(trials), size)]


def named(trials: Sequence[Trial]) -> str:
    """Which trials an error came from."""
    others = f" or one of the {len(trials) - 1} after it" if len(trials) > 1 else ""
    return f"participant {trials[0].participant}, {trials[0].condition}{others}: "
