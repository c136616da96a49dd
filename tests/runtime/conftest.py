"""A drive that a test steps, and that is let go when the test is over."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from multiprocessing.shared_memory import SharedMemory

import numpy as np
import pytest
from numpy.typing import NDArray

from costeer.runtime.setup import DriveSetup
from tests.runtime.rig import Rig


@pytest.fixture
def rig() -> Iterator[Callable[[DriveSetup], Rig]]:
    """Makes drives."""
    made: list[Rig] = []

    def make(setup: DriveSetup) -> Rig:
        made.append(Rig(setup))
        return made[-1]

    yield make
    for each in made:
        each.close()


@pytest.fixture
def torque_cell() -> Iterator[tuple[str, NDArray[np.float64]]]:
    memory = SharedMemory(create=True, size=8)
    cell: NDArray[np.float64] = np.ndarray(1, np.float64, memory.buf)
    cell[0] = 0.0
    yield memory.name, cell
    del cell
    memory.unlink()
