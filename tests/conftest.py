"""Settings of every test: random examples are the same ones in CI."""

from __future__ import annotations

import os

from hypothesis import settings

# No deadline: the first call of a compiled function takes seconds.
settings.register_profile("default", deadline=None)
settings.register_profile("ci", deadline=None, derandomize=True)
settings.load_profile("ci" if os.environ.get("CI") else "default")
