"""What ties the real-time process to the server."""

from __future__ import annotations

import socket
from multiprocessing.connection import Connection
from typing import NamedTuple


class Links(NamedTuple):
    """What ties the process to the others; it can be sent to a spawned one.

    Attributes:
        memory: Name of the shared memory.
        commands: Both ways: tuples of a word and its values.
        wake: A byte is sent for every frame.
    """

    memory: str
    commands: Connection
    wake: socket.socket
