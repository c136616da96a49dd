"""Sines and the like as arithmetic, for compiled code: the same bits on any machine.

A C library computes these functions its own way, one number at a time, and another
library rounds otherwise. Here they are polynomials made of additions, products and
quotients, which the standard rounds in one way (IEEE 754): a trial does not depend on
the C library, and eight trials are computed at once, each to the last bit what it is
alone (vectors.py). Each result is within 1 unit in the last place of the exact one,
tangents within 2.5 (`python -m benchmarks.elementary`).

Arguments are first brought near zero (W. J. Cody and W. Waite, Software Manual for the
Elementary Functions, 1980), where a polynomial in Chebyshev points comes nearer to the
function than rounding does. Plain Python, NumPy and JAX keep the functions of their
libraries (array.py), by which these here are checked.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from numba.extending import overload

from costeer.base import lanes
from costeer.base.lanes import anywhere, choose, power_of_two
from costeer.base.marks import compiled

__all__ = ["atan", "cos", "exp", "log", "sin", "tan", "tanh"]

# Any, in this file: a float, or a number of each of eight trials.

ROUNDER = 1.5 * 2.0**52
"""Added and taken off again it leaves the nearest whole number."""

NEAR = math.pi / 4.0
"""Angles up to here need no whole quarters of a turn taken off [rad]."""
FAR = 2.0**20
"""Beyond it quarters of a turn are no longer exact: the C library's function is taken
[rad]."""
QUARTERS_PER_RADIAN = 2.0 / math.pi
# A quarter of a turn in parts of 33 bits, whose products with a count below 2**20 are
# exact, and what is left.
QUARTER_1 = float.fromhex("0x1.921fb54400000p+0")
QUARTER_2 = float.fromhex("0x1.0b4611a600000p-34")
QUARTER_3 = float.fromhex("0x1.3198a2e000000p-69")
QUARTER_4 = float.fromhex("0x1.b839a252049c1p-104")

DOUBLINGS_PER_UNIT = 1.0 / math.log(2.0)
# The logarithm of 2: 32 bits, and what is left.
DOUBLING_1 = float.fromhex("0x1.62e42fee00000p-1")
DOUBLING_2 = float.fromhex("0x1.a39ef35793c76p-33")


def _of_library(function: Callable[[float], float]) -> Any:
    """The C library's function, of one number or of each of eight."""

    def named(x: Any) -> Any:
        return function(x)

    apart = lanes.each(function)

    @overload(named, strict=False)
    def _(x: Any) -> Any:
        if lanes.in_lanes(x):
            return lambda x: apart(x)
        return lambda x: function(x)

    return named


_sin_of_library = _of_library(math.sin)
_cos_of_library = _of_library(math.cos)
_tan_of_library = _of_library(math.tan)
log = _of_library(math.log)
"""Natural logarithm: seldom asked for, so the C library's."""


@compiled
def _sine(x: Any) -> Any:
    """Sine of an angle up to `NEAR`, without the angle itself."""
    z = x * x
    w = z * z
    low = -0.16666666666666666 + z * 0.008333333333330936
    middle = -0.00019841269836740532 + z * 2.7557316093198404e-06
    high = -2.5051129896450185e-08 + z * 1.5917988979397435e-10
    return (z * x) * (low + w * (middle + w * high))


@compiled
def _cosine(x: Any) -> Any:
    """Cosine of an angle up to `NEAR`, in two parts: rounded, and what it lacks."""
    z = x * x
    w = z * z
    low = 0.041666666666666664 + z * -0.0013888888888887389
    middle = 2.48015872987544e-05 + z * -2.755731726587808e-07
    high = 2.087614504941318e-09 + z * -1.1382544645349249e-11
    half = 0.5 * z
    rounded = 1.0 - half
    return rounded, ((1.0 - rounded) - half) + w * (low + w * (middle + w * high))


@compiled
def _less(x: Any, part: Any) -> Any:
    """Difference of two numbers, and what rounding has cost it."""
    found = x - part
    taken = x - found
    return found, (x - (found + taken)) + (taken - part)


@compiled
def _without_quarters(x: Any) -> Any:
    """Whole quarters of a turn in an angle, and what they leave in two parts [rad]."""
    count = (x * QUARTERS_PER_RADIAN + ROUNDER) - ROUNDER
    first = x - count * QUARTER_1
    second, lost = _less(first, count * QUARTER_2)
    third, lost_too = _less(second, count * QUARTER_3)
    rest = (lost + lost_too) - count * QUARTER_4
    near = third + rest
    return count, near, (third - near) + rest


@compiled
def _both(x: Any, rest: Any) -> Any:
    """Sine and cosine of an angle `x + rest`, where `rest` is far smaller than `x`."""
    rounded, lacking = _cosine(x)
    sine = x + (_sine(x) + rest * rounded)
    return sine, rounded + (lacking - x * rest)


@compiled
def _quarter(count: Any) -> Any:
    """Which of the four quarters: -2, -1, 0, 1 or 2, the first and last being one."""
    return count - 4.0 * ((0.25 * count + ROUNDER) - ROUNDER)


@compiled
def _far_sine(x: Any, ahead: Any) -> Any:
    """Of an angle beyond `NEAR`, so many quarters of a turn ahead."""
    count, near, rest = _without_quarters(x)
    quarter = _quarter(count + ahead)
    size = quarter * quarter
    sine, cosine = _both(near, rest)
    value = choose(size == 1.0, cosine, sine)
    return choose((quarter == -1.0) | (size == 4.0), -value, value)


@compiled
def _far_tangent(x: Any) -> Any:
    """Of an angle beyond `NEAR`."""
    count, near, rest = _without_quarters(x)
    quarter = _quarter(count)
    sine, cosine = _both(near, rest)
    odd = quarter * quarter == 1.0
    return choose(odd, -cosine, sine) / choose(odd, sine, cosine)


@compiled
def sin(x: Any) -> Any:
    """Sine of an angle in radians."""
    value = x + _sine(x)
    size = x * x
    if anywhere(size > NEAR * NEAR):
        value = choose(size > NEAR * NEAR, _far_sine(x, 0.0), value)
        if anywhere(size > FAR * FAR):
            value = choose(size > FAR * FAR, _sin_of_library(x), value)
    return value


@compiled
def cos(x: Any) -> Any:
    """Cosine of an angle in radians."""
    rounded, lacking = _cosine(x)
    value = rounded + lacking
    size = x * x
    if anywhere(size > NEAR * NEAR):
        value = choose(size > NEAR * NEAR, _far_sine(x, 1.0), value)
        if anywhere(size > FAR * FAR):
            value = choose(size > FAR * FAR, _cos_of_library(x), value)
    return value


@compiled
def tan(x: Any) -> Any:
    """Tangent of an angle in radians."""
    rounded, lacking = _cosine(x)
    value = (x + _sine(x)) / (rounded + lacking)
    size = x * x
    if anywhere(size > NEAR * NEAR):
        value = choose(size > NEAR * NEAR, _far_tangent(x), value)
        if anywhere(size > FAR * FAR):
            value = choose(size > FAR * FAR, _tan_of_library(x), value)
    return value


@compiled
def _angle_taken_off(x: Any) -> Any:
    """A tangent of at most 7/16 in size, above and below the line, and an angle.

    The angle, in two parts, is 0, atan(1/2), pi/4, atan(3/2) or pi/2; without it, that
    of a positive `x` has the tangent.
    """
    above, below = (
        choose(x < 2.4375, x - 1.5, -1.0),
        choose(x < 2.4375, 1.0 + 1.5 * x, x),
    )
    angle = choose(x < 2.4375, 0.982793723247329, 1.5707963267948966)
    rest = choose(x < 2.4375, 1.3903311031230998e-17, 6.123233995736766e-17)
    above, below = (
        choose(x < 1.1875, x - 1.0, above),
        choose(x < 1.1875, x + 1.0, below),
    )
    angle = choose(x < 1.1875, 0.7853981633974483, angle)
    rest = choose(x < 1.1875, 3.061616997868383e-17, rest)
    above = choose(x < 0.6875, 2.0 * x - 1.0, above)
    below = choose(x < 0.6875, 2.0 + x, below)
    angle = choose(x < 0.6875, 0.4636476090008061, angle)
    rest = choose(x < 0.6875, 2.2698777452961687e-17, rest)
    near = x < 0.4375
    above, below = choose(near, x, above), choose(near, 1.0, below)
    return above / below, choose(near, 0.0, angle), choose(near, 0.0, rest)


@compiled
def atan(x: Any) -> Any:
    """Angle in radians whose tangent is `x`."""
    t, angle, rest = _angle_taken_off(choose(x < 0.0, -x, x))
    z = t * t
    w = z * z
    low = (0.33333333333333326 + z * -0.19999999999987655) + w * (
        0.14285714283127662 + z * -0.11111110899049664
    )
    high = (0.0909090014058555 + z * -0.07692086204975024) + w * (
        0.06663224869084483 + z * -0.05847612444521365
    )
    top = (0.050334165154982353 + z * -0.0378116004846169) + w * 0.017532295994972764
    short = z * (low + (w * w) * (high + (w * w) * top))
    value = angle - ((t * short - rest) - t)
    return choose(x < 0.0, -value, value)


@compiled
def _grown(r: Any) -> Any:
    """`exp(r) - 1` for at most half a doubling of growth."""
    z = r * r
    w = z * z
    low = (0.5 + r * 0.1666666666666667) + z * (
        0.04166666666666667 + r * 0.008333333333326084
    )
    high = (0.0013888888888883711 + r * 0.0001984126987500228) + z * (
        2.480158732567746e-05 + r * 2.755725517000089e-06
    )
    top = (
        2.755727347871858e-07 + r * 2.5105312729622103e-08
    ) + z * 2.09147553258932e-09
    return r + z * (low + w * (high + w * top))


@compiled
def _doublings(x: Any) -> Any:
    """Whole doublings in the growth by `exp(x)`, and the exponent that they leave."""
    count = (x * DOUBLINGS_PER_UNIT + ROUNDER) - ROUNDER
    return count, (x - count * DOUBLING_1) - count * DOUBLING_2


@compiled
def exp(x: Any) -> Any:
    """Exponential function."""
    count, r = _doublings(x)
    half = (0.5 * count + ROUNDER) - ROUNDER
    grown = (1.0 + _grown(r)) * power_of_two(half)
    value = grown * power_of_two(count - half)
    return choose(x > 710.0, math.inf, choose(x < -746.0, 0.0, value))


@compiled
def tanh(x: Any) -> Any:
    """Hyperbolic tangent: `e / (e + 2)`, where `e` is `exp(2 x) - 1`."""
    size = choose(x < 0.0, -x, x)
    count, r = _doublings(2.0 * choose(size > 22.0, 22.0, size))
    scale = power_of_two(count)
    grown = (scale - 1.0) + scale * _grown(r)
    value = grown / (grown + 2.0)
    return choose(x < 0.0, -value, value)
