"""Random numbers of a trial, drawn before it by seeded NumPy generators.

Every engine then sees the same numbers. Each component has a stream of its own, so
that a longer trial begins like a shorter one.
"""

from __future__ import annotations

import zlib

import numpy as np
from numpy.typing import NDArray

from costeer.drivers.interface import NORMAL_DRAWS, DriverNoise

_TRIAL_STREAM = 1


def driver_noise(
    seed: int, participant: int, condition: str, num_steps: int
) -> NDArray[np.float64]:
    """Return the random numbers of a trial, shape `(num_steps, draw)`.

    Args:
        seed: Of the study.
        participant: Number of the driver.
        condition: Its name; every condition is another drive.
        num_steps: Control steps.
    """
    noise = np.empty((len(DriverNoise._fields), num_steps))
    draw_noise(seed, participant, condition, noise)
    return np.ascontiguousarray(noise.T)


def draw_noise(
    seed: int, participant: int, condition: str, noise: NDArray[np.float64]
) -> None:
    """Draw the random numbers of `driver_noise` into an array, `(draw, num_steps)`."""
    name = zlib.crc32(condition.encode())
    entropy = [seed, _TRIAL_STREAM, participant, name]
    streams = np.random.SeedSequence(entropy).spawn(len(noise))
    for draw, stream in enumerate(streams):
        generator = np.random.Generator(np.random.PCG64(stream))
        if draw < NORMAL_DRAWS:
            generator.standard_normal(out=noise[draw])
        else:
            generator.random(out=noise[draw])
