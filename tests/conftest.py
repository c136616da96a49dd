"""Settings of every test: random examples are the same in CI, shapes are checked."""

from __future__ import annotations

import os

from hypothesis import settings

from tests.shapes import check_shapes

# No deadline: the first call of a compiled function takes seconds.
# Fifty examples find what a hundred do, given that every run draws others; tracing for
# coverage makes each of them three times as slow.
settings.register_profile("default", deadline=None, max_examples=50)
settings.register_profile("ci", deadline=None, max_examples=50, derandomize=True)
settings.register_profile("thorough", deadline=None, max_examples=1000)
usual = "ci" if os.environ.get("CI") else "default"
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", usual))

check_shapes()
