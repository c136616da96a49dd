"""A drive that a test steps, and that is let go when the test is over."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import pytest

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
