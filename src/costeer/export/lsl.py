"""A trial as it goes on, as two streams of Lab Streaming Layer: state and markers.

LabRecorder writes them into an XDF file beside the EEG, eye tracker or camera of the
same laboratory, on one clock. Needs the package `pylsl` (extra `lsl`).
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence

from costeer.runtime.markers import Marker, as_json

STATE_TYPE = "DrivingState"
"""Type of the stream of numbers."""

MARKER_TYPE = "Markers"
"""Type of the stream of markers, as Lab Streaming Layer has it by custom."""


def lsl_clock() -> float:
    """Now, on the clock of Lab Streaming Layer [s].

    Raises:
        ModuleNotFoundError: If `pylsl` is not installed.
    """
    import pylsl

    return float(pylsl.local_clock())


class TrialOutlet:
    """Offers a trial to the programs of a laboratory.

    Args:
        columns: Name and unit of each number of a sample, in their order.
        rate: Samples that come in a second [1/s].
        name: Of the trial; the streams are called `<name>` and `<name>-markers`.
        source: Tells this simulator from others. A recorder that knows it picks the
            streams up again after a restart.

    Raises:
        ValueError: If there are no columns.
        ModuleNotFoundError: If `pylsl` is not installed.
    """

    def __init__(
        self,
        columns: Mapping[str, str],
        rate: float = 60.0,
        name: str = "costeer",
        source: str = "costeer",
    ) -> None:
        import pylsl

        if not columns:
            raise ValueError("a stream has 0 columns; give at least one")
        self._num_columns = len(columns)
        state = pylsl.StreamInfo(
            name, STATE_TYPE, len(columns), rate, pylsl.cf_double64, f"{source}-state"
        )
        channels = state.desc().append_child("channels")
        for label, unit in columns.items():
            channel = channels.append_child("channel")
            channel.append_child_value("label", label)
            channel.append_child_value("unit", unit)
        markers = pylsl.StreamInfo(
            f"{name}-markers", MARKER_TYPE, 1, 0.0, pylsl.cf_string, f"{source}-markers"
        )
        self._state = pylsl.StreamOutlet(state)
        self._markers = pylsl.StreamOutlet(markers)

    def push(self, sample: Sequence[float], time: float = 0.0) -> None:
        """Give one sample.

        Args:
            sample: A number for each column.
            time: Of the sample, on the clock of `lsl_clock` [s]; now if 0.

        Raises:
            ValueError: If it has more or fewer numbers than there are columns.
        """
        if len(sample) != self._num_columns:
            raise ValueError(
                f"a sample has {len(sample)} numbers; the stream has "
                f"{self._num_columns} columns"
            )
        self._state.push_sample([float(value) for value in sample], time)

    def mark(self, marker: Marker, time: float = 0.0) -> None:
        """Give one marker: its fields as a JSON object.

        Args:
            marker: What happened.
            time: When, on the clock of `lsl_clock` [s]; now if 0.
        """
        told = json.dumps(as_json(marker), ensure_ascii=False)
        self._markers.push_sample([told], time)

    def close(self) -> None:
        """Withdraw both streams; nothing can be given any more."""
        del self._state, self._markers
