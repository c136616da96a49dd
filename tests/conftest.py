"""Settings of every test: random examples are the same in CI, shapes are checked."""

from __future__ import annotations

import os

from hypothesis import settings

from tests.shapes import check_shapes

# No deadline: the first call of a compiled function takes seconds.
settings.register_profile("default", deadline=None)
settings.register_profile("ci", deadline=None, derandomize=True)
settings.load_profile("ci" if os.environ.get("CI") else "default")

check_shapes()
