"""How well a cheaper form of the window agrees with the exact one.

A trigger is what the controller makes of verdicts: three in a row of at least 0.5. The
probability itself enters nothing else in the loop, so a form with the same triggers at
every sample gives the same drive, verdict by verdict from the first.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.training.triggers import TriggerParameters, onsets, sustained

TRIGGER = TriggerParameters(merge=0.0)
REACH = 60
"""Samples by which a trigger may be shifted before it is another one [-]."""

_BINS = 10_000


class Agreement(NamedTuple):
    """Of one form with the exact window, over some recordings; sums but for `largest`.

    Attributes:
        samples: With a verdict.
        seconds: That the form took for all samples [s].
        ticks: All samples, with or without a verdict.
        histogram: Of the differences in probability, in steps of 1e-4, `(bin,)`.
        largest: Difference in probability [-].
        verdicts: Samples at which one is at least 0.5 and the other is not.
        held: Samples at which one triggers and the other does not.
        missing: Triggers of the exact window without one of the form.
        extra: The other way round.
        shifted: Triggers at another sample.
        lowest: Probability of the form where the exact one triggers, the lowest [-].
        stirred: Samples at which the form is at least at each of some gates, `(gate,)`.
    """

    samples: int
    seconds: float
    ticks: int
    histogram: NDArray[np.int64]
    largest: float
    verdicts: int
    held: int
    missing: int
    extra: int
    shifted: int
    lowest: float
    stirred: NDArray[np.int64]


def agreement(
    exact: NDArray[np.float64],
    form: NDArray[np.float64],
    seconds: float,
    gates: tuple[float, ...] = (),
) -> Agreement:
    """Compare the verdicts of one recording.

    Args:
        exact: Of the exact window, `(time,)`.
        form: Of the cheaper form, `(time,)`.
        seconds: That the form took [s].
        gates: At which its probability is counted [-].

    Raises:
        ValueError: If one has a verdict where the other has none.
    """
    known = np.isfinite(exact)
    if not np.array_equal(known, np.isfinite(form)):
        raise ValueError("exact window and cheaper form have verdicts at other samples")
    gap = np.abs(exact - form)[known]
    held, also = (sustained(p, TRIGGER) >= TRIGGER.threshold for p in (exact, form))
    missing, extra, shifted = matched(onsets(exact, TRIGGER), onsets(form, TRIGGER))
    positive = (exact >= TRIGGER.threshold) != (form >= TRIGGER.threshold)
    return Agreement(
        samples=int(known.sum()),
        seconds=seconds,
        ticks=len(exact),
        histogram=np.histogram(gap, _BINS, (0.0, 1.0))[0],
        largest=float(gap.max(initial=0.0)),
        verdicts=int(positive.sum()),
        held=int((held != also).sum()),
        missing=missing,
        extra=extra,
        shifted=shifted,
        lowest=float(form[held].min(initial=1.0)),
        stirred=np.array([np.sum(form >= gate) for gate in gates], np.int64),
    )


def matched(exact: NDArray[np.int64], form: NDArray[np.int64]) -> tuple[int, int, int]:
    """How many triggers are missing, extra and shifted.

    Each trigger of the exact window without one of the form at the same sample takes
    the nearest one that is still free and within `REACH`.

    Args:
        exact: Samples at which they begin, ascending.
        form: The same of the form.
    """
    alone = np.setdiff1d(exact, form)
    free = np.setdiff1d(form, exact)
    missing = 0
    for at in alone:
        distance = np.abs(free - at)
        if distance.min(initial=REACH + 1) > REACH:
            missing += 1
        else:
            free = np.delete(free, np.argmin(distance))
    return missing, len(free), len(alone) - missing


def joined(one: Agreement, other: Agreement) -> Agreement:
    """Both sets of recordings together."""
    sums: list[Any] = [
        a + b  # Any: integers, floats and arrays
        for a, b in zip(tuple[Any, ...](one), other, strict=True)
    ]
    return Agreement(*sums)._replace(
        largest=max(one.largest, other.largest),
        lowest=min(one.lowest, other.lowest),
    )


def percentile(found: Agreement, percent: float) -> float:
    """Percentile of the differences in probability, rounded up to 1e-4 [-]."""
    reached = np.cumsum(found.histogram) >= percent / 100.0 * found.samples
    return float(np.argmax(reached) + 1) / _BINS
