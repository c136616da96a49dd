"""Least squares on what a wheel did: torque curve, inertia, damping, friction, delay.

With all signals through one smooth window the equation of the wheel holds as it is,

    rate' = torque of the command / inertia - damping / inertia · rate
            - friction / inertia · sign of the rate,

and is linear in its unknowns: one for each level of the command, and two. Only ratios
come out; a reference torque gives the scale. The delay is the one that leaves least.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize_scalar

from costeer.devices.wheels.excitation import LEVELS, Excitation, SelfTestStopped

LEAST_EXPLAINED = 0.9
"""Share of the acceleration's variance below which something else moved the wheel."""

LONGEST_LATENCY = 0.08
"""Delays up to this are looked for [s]."""

_WINDOWS = (0.01, 0.02, 0.03)
_WELL_EXPLAINED = 0.98
_STILL = 0.15
_USABLE = 0.85
_LEAST_ROWS = 500
_LEAST_PUSHES = 0.05
_FLAT = 0.004

Signal = NDArray[np.float64]


class Mechanics(NamedTuple):
    """A wheel by itself, where full torque counts as one.

    Attributes:
        direction: +1 if a positive command makes the angle grow, else -1.
        curve: Commands and their shares of the largest torque; grows from (0, 0).
        tried: Highest command that was pushed with; above the end of the curve if the
            last levels add nothing.
        inertia: Over the largest torque [s²].
        damping: Over the largest torque [s].
        friction: Over the largest torque [-].
        latency: From a command to the first movement that is read [s].
        explained: Share of the acceleration's variance that the model gives [-].
    """

    direction: float
    curve: tuple[tuple[float, float], ...]
    tried: float
    inertia: float
    damping: float
    friction: float
    latency: float
    explained: float


class _Signals(NamedTuple):
    """Smoothed signals on an even grid; `commands` has a column for each level."""

    time: Signal
    rate: Signal
    acceleration: Signal
    direction: Signal
    usable: Signal
    commands: Signal
    levels: tuple[float, ...]


class _Solution(NamedTuple):
    """Coefficients of one delay, and the share of the variance that they leave."""

    coefficients: Signal
    unexplained: float


def fit_mechanics(excitation: Excitation, dt: float) -> Mechanics:
    """Find the wheel that did what was seen.

    Args:
        excitation: Pushes of many levels, both ways.
        dt: Between readings [s].

    Raises:
        SelfTestStopped: If too little was seen, or something else moved the wheel.
    """
    signals, latency, solution = _best_fit(excitation, dt)
    coefficients, unexplained = solution
    gains, slowing = coefficients[:-2], -coefficients[-2:]
    direction = 1.0 if gains.sum() > 0.0 else -1.0
    curve = _growing_curve(signals, direction * gains)
    if unexplained > 1.0 - LEAST_EXPLAINED or not curve:
        raise SelfTestStopped(
            f"the commands explain {1.0 - unexplained:.0%} of the movement, which is "
            "too little: hands or something else moved the wheel; keep away, then run "
            "it again"
        )
    largest = curve[-1][1]
    return Mechanics(
        direction=direction,
        curve=tuple((command, gain / largest) for command, gain in curve),
        tried=signals.levels[-1],
        inertia=1.0 / largest,
        damping=max(float(slowing[0]) / largest, 0.0),
        friction=max(float(slowing[1]) / largest, 0.0),
        # A command is held until the next: its middle is half a step after its start.
        latency=max(latency - dt / 2.0, 0.0),
        explained=1.0 - unexplained,
    )


def _best_fit(excitation: Excitation, dt: float) -> tuple[_Signals, float, _Solution]:
    """Signals, latency [s] and solution of the shortest window that explains well.

    An axis of few bits, or one that is seldom sent, makes noise that a longer window
    takes away.
    """
    fits = []
    for width in _WINDOWS:
        signals = _smoothed(excitation, dt, width)
        latency = _best_latency(signals)
        fits.append((signals, latency, _solved(signals, latency)))
        if fits[-1][2].unexplained < 1.0 - _WELL_EXPLAINED:
            break
    return min(fits, key=lambda fit: fit[2].unexplained)


def _smoothed(excitation: Excitation, dt: float, width: float) -> _Signals:
    """All signals through the same window, so that the equation holds between them."""
    time = np.arange(excitation.time[0], excitation.time[-1], dt)
    if time.size < _LEAST_ROWS:
        raise SelfTestStopped("the wheel was pushed too briefly; run it again")
    angle = np.interp(time, excitation.time, excitation.angle)
    angle -= angle.mean()
    held = np.searchsorted(excitation.time, time + dt / 2.0, side="right") - 1
    command = excitation.command[held]
    window, slope, bend = _windows(dt, width)
    rate = _through(slope, angle)
    still = _through(window, (np.abs(rate) < _STILL).astype(np.float64))
    levels = tuple(
        level
        for level in LEVELS
        if np.count_nonzero(np.abs(command) == level) * dt > _LEAST_PUSHES
    )
    known = np.isin(np.abs(command), (0.0, *levels)).astype(np.float64)
    columns = [
        _through(window, np.sign(command) * (np.abs(command) == level))
        for level in levels
    ]
    return _Signals(
        time=time,
        rate=rate,
        acceleration=_through(bend, angle),
        direction=_through(window, np.sign(rate)),
        usable=np.minimum(1.0 - still, _through(window, known)),
        commands=np.array(columns).T.reshape(time.size, len(levels)),
        levels=levels,
    )


def _windows(dt: float, width: float) -> tuple[Signal, Signal, Signal]:
    """A Gaussian window and its two derivatives, which are exact on a parabola."""
    reach = round(4.0 * width / dt)
    time = dt * np.arange(-reach, reach + 1)
    window = np.exp(-0.5 * (time / width) ** 2)
    window /= window.sum()
    slope = -time * window
    slope /= -(slope * time).sum()
    bend = (time**2 - (time**2 * window).sum()) * window
    bend /= 0.5 * (bend * time**2).sum()
    return window, slope, bend


def _through(window: Signal, signal: Signal) -> Signal:
    """A signal through a window, as long as it was."""
    smooth: Signal = np.convolve(signal, window, mode="same")
    return smooth


def _best_latency(signals: _Signals) -> float:
    """Delay that leaves the least of the acceleration unexplained [s]."""

    def unexplained(latency: float) -> float:
        return _solved(signals, latency).unexplained

    grid = np.arange(0.0, LONGEST_LATENCY + 0.002, 0.004)
    best = float(grid[np.argmin([unexplained(float(each)) for each in grid])])
    around = (max(best - 0.004, 0.0), best + 0.004)
    found = minimize_scalar(
        unexplained, bounds=around, method="bounded", options={"xatol": 5e-5}
    )
    return float(found.x)


def _solved(signals: _Signals, latency: float) -> _Solution:
    """Least squares if the wheel answers after `latency` [s]."""
    later = signals.time + latency
    rate, acceleration, direction, usable = (
        np.interp(later, signals.time, each)
        for each in (
            signals.rate,
            signals.acceleration,
            signals.direction,
            signals.usable,
        )
    )
    margin = np.searchsorted(signals.time, signals.time[0] + LONGEST_LATENCY)
    rows = usable > _USABLE
    rows[:margin] = rows[-margin:] = False
    if np.count_nonzero(rows) < _LEAST_ROWS:
        raise SelfTestStopped(
            "the wheel hardly moved under the pushes: it is held, or its force is too "
            "weak for its friction; take your hands off, then run it again"
        )
    known = np.column_stack([signals.commands, rate, direction])[rows]
    wanted = acceleration[rows]
    square, side = known.T @ known, known.T @ wanted
    coefficients = np.linalg.lstsq(square, side, rcond=1e-12)[0]
    left = wanted - known @ coefficients
    return _Solution(coefficients, float(left @ left / (wanted @ wanted)))


def _growing_curve(signals: _Signals, gains: Signal) -> list[tuple[float, float]]:
    """Pairs of command and gain that grow; levels that add nothing are left out.

    Neighbours in the wrong order take their mean, weighted by how long they were
    pushed, as isotonic regression does.
    """
    weights = np.abs(signals.commands).sum(axis=0)
    blocks: list[list[float]] = []
    for gain, weight in zip(gains.tolist(), weights.tolist(), strict=True):
        blocks.append([gain, weight, 1])
        while len(blocks) > 1 and blocks[-2][0] >= blocks[-1][0]:
            late, early = blocks.pop(), blocks.pop()
            total = late[1] + early[1]
            mean = (late[0] * late[1] + early[0] * early[1]) / total
            blocks.append([mean, total, late[2] + early[2]])
    even = [block[0] for block in blocks for _ in range(int(block[2]))]
    curve = [(0.0, 0.0)]
    for level, gain in zip(signals.levels, even, strict=True):
        if gain > curve[-1][1] + _FLAT * max(even[-1], 0.0):
            curve.append((level, gain))
    return curve if len(curve) > 1 else []
