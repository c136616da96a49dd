"""Eight trials at a time through the same steps (base/lanes.py).

The trials of a block share road, sensors and time; each lane has its own driver, car,
condition and random numbers. A lane whose trial has ended runs on until all have; what
it does then is not kept. Each trial is bit for bit what it is alone.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.base import array as xp
from costeer.base import lanes
from costeer.base.array import compiled
from costeer.base.packing import unpack_lanes
from costeer.drivers.interface import DriverNoise
from costeer.intention.starts import BracketState
from costeer.loop.endings import has_stopped, still
from costeer.loop.events import has_collided
from costeer.loop.parameters import LoopParameters
from costeer.loop.rows import LoopRule
from costeer.loop.tick import Network, Script, tick

Numbers = NDArray[np.float64]

BUFFER = 64
"""Steps whose random numbers and rows lie together in the order of the lanes."""

SHARED = (
    "road",
    "traffic",
    "sensors",
    "plant_steps",
    "following",
    "alignment",
    "stretches",
)
"""Parameters that the trials of a block have in common."""

_NOISE = DriverNoise(*([0.0] * len(DriverNoise._fields)))


class Block(NamedTuple):
    """Arrays of a block of trials.

    Attributes:
        parameters: Of each, without the shared ones, `(number, lane)`.
        state: At the start, `(number, lane)`.
        noise: Random numbers, `(lane, draw, time)`.
        rows: Filled, `(lane, column, time)`.
        counts: Rows of each trial, filled, `(lane,)`.
    """

    parameters: Numbers
    state: Numbers
    noise: Numbers
    rows: Numbers
    counts: NDArray[np.int64]


def own(parameters: LoopParameters[Any]) -> LoopParameters[Any]:
    """The parameters without the shared ones."""
    nothing: Any = None  # Any: only `joined` meets it
    return parameters._replace(**dict.fromkeys(SHARED, nothing))


@compiled
def joined(each: Any, shared: Any) -> Any:  # Any: parameters in lanes
    """Parameters of which some are each trial's own."""
    return LoopParameters(
        controller=each.controller,
        car=each.car,
        column=each.column,
        road=shared.road,
        traffic=shared.traffic,
        sensors=shared.sensors,
        driver=each.driver,
        start=each.start,
        follows_plan=each.follows_plan,
        assists=each.assists,
        plant_steps=shared.plant_steps,
        following=shared.following,
        alignment=shared.alignment,
        fleet=each.fleet,
        stretches=shared.stretches,
        mistakes=each.mistakes,
    )


@compiled
def _drawn(noise: Numbers, first: int, count: int, drawn: Numbers) -> None:
    """Bring random numbers of some steps into the order of the lanes."""
    for lane in range(noise.shape[0]):
        for draw in range(noise.shape[1]):
            for step in range(count):
                drawn[step, draw, lane] = noise[lane, draw, first + step]


@compiled
def _written(filled: Numbers, rows: Numbers, first: int, count: int) -> None:
    """Bring the rows of some steps into the order of the trials."""
    for lane in range(rows.shape[0]):
        for column in range(rows.shape[1]):
            for step in range(count):
                rows[lane, column, first + step] = filled[step, column, lane]


@compiled
def run_block(
    loop: LoopRule[Any, Any],
    parameters: Any,  # Any: with numbers in lanes, also the state
    state: Any,
    script: Script,
    network: Network,
    block: Block,
) -> None:
    """Fill the rows of eight trials until all have ended or random numbers have.

    Args:
        loop: The functions of the loop.
        parameters: Of the trials.
        state: At the beginning.
        script: Where the crossing probability comes from.
        network: Of the intention, memory with an axis of lanes first.
        block: Random numbers, rows and their counts.
    """
    noise, rows, counts = block.noise, block.rows, block.counts
    drawn = np.empty((BUFFER, noise.shape[1], lanes.WIDTH))
    filled = np.empty((BUFFER, rows.shape[1], lanes.WIDTH))
    standing, over = lanes.spread(0.0), lanes.spread(False)
    length = parameters.road.length
    steps, first = noise.shape[2], 0
    while first < steps and not lanes.all_lanes(over):
        count = min(BUFFER, steps - first)
        _drawn(noise, first, count, drawn)
        for step in range(count):
            given = unpack_lanes(_NOISE, drawn[step])
            new, sample = tick(loop.rules, parameters, state, script, network, given)
            state = lanes.spread(new)
            loop.fill(filled[step], lanes.spread(sample))
            speed = sample.measurement.longitudinal_velocity
            standing = lanes.spread(still(standing, speed))
            ends = has_collided(sample.events) | has_stopped(standing)
            there = state.world.vehicle.longitudinal_position >= length
            ended = (ends | there) & xp.logical_not(over)
            if lanes.any_lane(ended):
                for lane in range(lanes.WIDTH):
                    if lanes.of_lane(ended, lane):
                        counts[lane] = first + step + 1
            over = over | ended
        _written(filled, rows, first, count)
        first += count


def stacked(networks: Sequence[Network]) -> Network:
    """The networks of a block as one: memory with an axis of lanes first."""

    def together(memories: Sequence[BracketState]) -> BracketState:
        return BracketState(*map(np.stack, zip(*memories, strict=True)))

    return Network(
        weights=networks[0].weights,
        memory=together([network.memory for network in networks]),
        beyond=together([network.beyond for network in networks]),
    )
