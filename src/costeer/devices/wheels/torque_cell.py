"""One number in shared memory: the torque of a simulated wheel, for others to see."""

from __future__ import annotations

import struct
from multiprocessing.shared_memory import SharedMemory

_NUMBER = struct.Struct("d")


class TorqueCell:
    """The torque that a simulated motor gives [N·m], in memory that another made.

    Only for processes that `multiprocessing` started: any other would remove the
    memory when it ends, because Python before 3.13 believes that it is its own.
    """

    size = _NUMBER.size

    def __init__(self, name: str) -> None:
        """Attach the memory.

        Args:
            name: Of the shared memory, of at least `size` bytes.

        Raises:
            FileNotFoundError: If there is no such memory.
        """
        self._memory = SharedMemory(name)

    def read(self) -> float:
        """Torque that was written last [N·m]."""
        (torque,) = _NUMBER.unpack_from(self._content())
        return float(torque)

    def write(self, torque: float) -> None:
        """Show a torque [N·m]."""
        _NUMBER.pack_into(self._content(), 0, torque)

    def close(self) -> None:
        """Let the memory go; who made it removes it."""
        self._memory.close()

    def _content(self) -> memoryview:
        content = self._memory.buf
        if content is None:
            raise ValueError("the torque cell is closed; open it again")
        return content
