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
    name = zlib.crc32(condition.encode())
    entropy = [seed, _TRIAL_STREAM, participant, name]
    streams = np.random.SeedSequence(entropy).spawn(len(DriverNoise._fields))
    noise = np.empty((num_steps, len(streams)))
    for column, stream in enumerate(streams):
        generator = np.random.Generator(np.random.PCG64(stream))
        if column < NORMAL_DRAWS:
            noise[:, column] = generator.standard_normal(num_steps)
        else:
            noise[:, column] = generator.random(num_steps)
    return noise
