"""The user's folder: calibrations of wheels and of heads."""

from __future__ import annotations

import os
import sys
from collections.abc import Mapping
from pathlib import Path


def home_folder(
    environment: Mapping[str, str] | None = None, platform: str | None = None
) -> Path:
    """Folder of the user's calibrations; nobody has made it yet, perhaps.

    `$COSTEER_HOME` if it is set, else `costeer` in the place where the system keeps
    settings: `%APPDATA%`, `~/Library/Application Support`, `$XDG_CONFIG_HOME` or
    `~/.config`.

    Args:
        environment: Variables; those of the process if None.
        platform: As `sys.platform`; that of the process if None.
    """
    variables = os.environ if environment is None else environment
    chosen = variables.get("COSTEER_HOME", "").strip()
    if chosen:
        return Path(chosen).expanduser()
    system = sys.platform if platform is None else platform
    return _settings_folder(variables, system) / "costeer"


def _settings_folder(variables: Mapping[str, str], system: str) -> Path:
    """Where programs of the user keep their settings."""
    if system == "win32":
        return _folder(variables, "APPDATA", Path.home() / "AppData" / "Roaming")
    if system == "darwin":
        return Path.home() / "Library" / "Application Support"
    return _folder(variables, "XDG_CONFIG_HOME", Path.home() / ".config")


def _folder(variables: Mapping[str, str], name: str, otherwise: Path) -> Path:
    """The folder that a variable names, if it is a whole path."""
    named = Path(variables.get(name, ""))
    return named if named.is_absolute() else otherwise
