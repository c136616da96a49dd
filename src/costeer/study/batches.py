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


def _unknown(_: Trial) -> float:
    """How long a trial lasts, if nobody can tell."""
    return 0.0


class Work(NamedTuple):
    """How trials are finished; a worker elsewhere can do it.

    Attributes:
        one: Finishes one trial.
        several: Finishes trials together; None where they cannot be.
        lasting: How long a trial of the same participant likely lasts, in any unit.
    """

    one: Callable[[Trial], TrialDone]
    several: Callable[[Sequence[Trial]], list[TrialDone]] | None = None
    lasting: Callable[[Trial], float] = _unknown

    def done(self, trials: Sequence[Trial]) -> list[TrialDone]:
        """Finish some trials."""
        if len(trials) == 1 or self.several is None:
            return [self.one(trial) for trial in trials]
        return self.several(trials)

    def batches(self, trials: Sequence[Trial]) -> list[Sequence[Trial]]:
        """The trials in batches: of one, or of as many as are driven together.

        Those that last as long come together: a batch lasts as long as its longest.
        """
        if self.several is None or len(trials) < TOGETHER_FROM:
            return [[trial] for trial in trials]
        one_of = {trial.participant: trial for trial in trials}
        lasting = {who: self.lasting(trial) for who, trial in one_of.items()}
        ordered = sorted(trials, key=lambda trial: lasting[trial.participant])
        places = range(0, len(trials), WIDTH)
        return [ordered[first : first + WIDTH] for first in places]


def named(trials: Sequence[Trial]) -> str:
    """Which trials an error came from."""
    others = f" or one of {len(trials) - 1} driven with it" if len(trials) > 1 else ""
    return f"participant {trials[0].participant}, {trials[0].condition}{others}: "
