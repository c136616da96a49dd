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


def wilson_interval(count: int, number: int) -> tuple[float, float]:
    """Interval of a share, Wilson (1927) [-].

    Args:
        count: Of those that have the property.
        number: Of all, above 0.
    """
    from scipy.special import ndtri

    z = float(ndtri(1.0 - (1.0 - CONFIDENCE) / 2.0))
    share = count / number
    scale = 1.0 + z * z / number
    middle = (share + z * z / (2.0 * number)) / scale
    spread = share * (1.0 - share) / number + z * z / (4.0 * number * number)
    half = z * float(spread**0.5) / scale
    return max(middle - half, 0.0), min(middle + half, 1.0)
