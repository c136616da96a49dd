"""How sure a counted rate is, none counted included."""

from __future__ import annotations

from costeer.study.quantities import CONFIDENCE


def poisson_interval(count: int, exposure: float) -> tuple[float, float]:
    """Interval of a rate from a count, Garwood (1936) [1 per unit of exposure].

    Exact and two-sided. Where nothing was counted the upper end is
    -ln(0.025) / exposure, 3.69 / exposure.

    Args:
        count: Events that were counted.
        exposure: In which they were, above 0.
    """
    from scipy.special import gammaincinv

    tail = (1.0 - CONFIDENCE) / 2.0
    low = gammaincinv(count, tail) if count else 0.0
    high = gammaincinv(count + 1, 1.0 - tail)
    return float(low / exposure), float(high / exposure)
