"""What a bug report needs to know of a computer, without who or where it is."""

from __future__ import annotations

import getpass
import os
import platform
import re
import socket
import sys
import tempfile
from collections.abc import Iterable, Mapping
from importlib.metadata import requires
from pathlib import Path

from costeer.base.entry import cache_folder
from costeer.doctor import Finding, installed_version, plain_requirements

_PATH = re.compile(r"(?<![\w/~.:])(?:[A-Za-z]:[\\/]|\\\\|/)(?!dev/|etc/)[^:;,'\"\n]+")
"""A path from the root on, spaces in it too; the system's own folders are no secret."""
_EXTRA = re.compile(r"^([A-Za-z0-9._-]+).*extra == ['\"]([a-z]+)['\"]")
_TOLD = ("COSTEER_", "NUMBA_", "JAX_", "OMP_NUM_THREADS")
"""Beginnings of the environment variables that change what costeer does."""


def bug_report(findings: Iterable[Finding], folder: Path) -> str:
    """Versions, platform, settings and findings, to be pasted into an issue.

    Args:
        findings: Of `costeer.doctor.examine`.
        folder: Where results would be written; its path is left out as others are.
    """
    extras = packages_of_extras()
    listed = {name for names in extras.values() for name in names} | {"Packages"}
    secrets = secret_words(folder)
    lines = [
        f"costeer {installed_version('costeer') or 'not installed'}",
        f"Python {platform.python_version()} ({platform.python_implementation()})",
        f"Platform: {platform.platform()}, {platform.machine()}",
        f"Packages: {_versions(plain_requirements())}",
        *(f"Extra {name}: {_versions(names)}" for name, names in extras.items()),
        f"Set in the environment: {', '.join(_set_variables()) or 'nothing'}",
        f"Compiled code: {_kept_code()}",
    ]
    lines += [
        f"{each.name}: {each.status}, {without_names(each.detail, secrets)}"
        for each in findings
        if each.name not in listed
    ]
    return "\n".join(lines)


def packages_of_extras() -> dict[str, list[str]]:
    """Packages that each extra of costeer brings; those of development left out."""
    extras: dict[str, list[str]] = {}
    for line in requires("costeer") or ():
        found = _EXTRA.match(line)
        if found and found[2] != "dev":
            extras.setdefault(found[2], []).append(found[1])
    return extras


def _versions(names: Iterable[str]) -> str:
    """Packages with the versions that are installed; a dash where there is none."""
    return ", ".join(
        f"{name} {installed_version(name) or '-'}" for name in sorted(names)
    )


def _set_variables() -> list[str]:
    """Names of the environment variables that matter; values may hold paths."""
    return sorted(name for name in os.environ if name.startswith(_TOLD))


def _kept_code() -> str:
    """How much machine code is kept for this version of the source."""
    try:
        sizes = [f.stat().st_size for f in cache_folder().rglob("*") if f.is_file()]
    except OSError as error:
        return f"not readable ({error.strerror})"
    return f"{len(sizes)} files, {sum(sizes) / 1e6:.1f} MB"


def secret_words(folder: Path) -> dict[str, str]:
    """Folders of the user and names of user and computer, and what replaces each."""
    folders = {
        "OUT": folder.absolute(),
        "HERE": Path.cwd(),
        "ENVIRONMENT": Path(sys.prefix),
        "TEMPORARY": Path(tempfile.gettempdir()),
    }
    secrets = {str(path): name for name, path in folders.items()}
    try:
        secrets[str(Path.home())] = "HOME"
        secrets[getpass.getuser()] = "USER"
    except (RuntimeError, KeyError, OSError):  # a user without a name has no secret
        pass
    for host in (platform.node(), socket.gethostname(), socket.getfqdn()):
        secrets[host] = secrets[host.split(".")[0]] = "HOST"
    return secrets


def without_names(text: str, secrets: Mapping[str, str]) -> str:
    """The text without the secrets and without any other path.

    Args:
        text: To be published.
        secrets: What must not be in it, and the word that stands there instead; of a
            folder, what follows it in a path is left out too.
    """
    for secret in sorted(secrets, key=len, reverse=True):
        if len(secret) > 1:
            whole = rf"(?<!\w){re.escape(secret)}(?!\w)(?:[\\/][^:;,'\"\n]*)?"
            text = re.sub(whole, secrets[secret], text, flags=re.IGNORECASE)
    return _PATH.sub("PATH", text)
