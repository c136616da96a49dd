"""What a worker is: its costeer must be the client's, and Ctrl-C is not its affair."""

from __future__ import annotations

import hashlib
import os
import signal
import socket
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import NamedTuple

_NO_WORK = ("web", "__pycache__")
"""Folders whose files do no work on a worker."""


class Facts(NamedTuple):
    """What decides the bytes of a result besides the task.

    Attributes:
        costeer: Version.
        sources: Hash of costeer's files.
        numpy: Version.
        numba: Version.
    """

    costeer: str
    sources: str
    numpy: str
    numba: str


class OtherWorkerError(ValueError):
    """A worker with another costeer than the client."""


@cache
def facts() -> Facts:
    """What costeer is in this process."""
    package = Path(__file__).parents[1]
    return Facts(
        _version("costeer"), sources_of(package), _version("numpy"), _version("numba")
    )


def _version(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:
        return "not installed"


def sources_of(package: Path) -> str:
    """Hash of all files of a package, but those of web pages, in path order."""
    digest = hashlib.sha256()
    for file in sorted(package.rglob("*")):
        parts = file.relative_to(package).parts
        if set(parts) & set(_NO_WORK) or not file.is_file():
            continue
        digest.update("/".join(parts).encode() + b"\0")
        digest.update(file.read_bytes())
    return digest.hexdigest()[:16]


def place() -> str:
    """Which process this is, in words."""
    return f"process {os.getpid()} on {socket.gethostname()}"


def refuse_other(wanted: Facts) -> None:
    """Refuse to work for a client with another costeer.

    Raises:
        OtherWorkerError: Naming worker, client and what differs.
    """
    told = differing(wanted, facts())
    if told:
        raise OtherWorkerError(refusal(place(), told))


def differing(wanted: Facts, found: Facts) -> str:
    """In what a worker differs from the client, in words; empty if in nothing."""
    return ", ".join(
        f"{name} {there} there and {here} here"
        for name, here, there in zip(Facts._fields, wanted, found, strict=True)
        if here != there
    )


def refusal(worker: str, told: str) -> str:
    """Say that a worker is refused, and the way out."""
    return (
        f"the worker {worker} has another costeer than this computer: {told}; install "
        "the same there and start it again"
    )


def dask_setup(_: object) -> None:
    """Leave Ctrl-C to the client, which lets the workers finish; called by Dask."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
