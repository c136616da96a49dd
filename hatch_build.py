"""Build hook: fetch the page's libraries, so that wheel and sdist ship them."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface


class PageHook(BuildHookInterface):  # type: ignore[type-arg]  # of no other hook's use
    """Runs `requirements/page.py` before a wheel, an editable install or an sdist."""

    PLUGIN_NAME = "custom"

    # Any: hatchling's own record of the build, left as it is.
    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Fetch the libraries; a build without them is a warning, not a failure."""
        del version, build_data
        script = Path(self.root) / "requirements" / "page.py"
        if script.is_file():
            subprocess.run([sys.executable, str(script)], check=False)
