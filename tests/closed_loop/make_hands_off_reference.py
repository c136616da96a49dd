"""Make the reference of the hands-off closed loop.

    python -m tests.closed_loop.make_hands_off_reference

Run it only when the loop is meant to answer differently, and say why in the commit.
"""

from __future__ import annotations

import csv
import io
from pathlib import Path

from benchmarks.hands_off import OFFSET, hands_off_setup
from costeer.loop.scenario import TrialSetup
from costeer.loop.trial import simulate_trial

FILE = Path(__file__).with_name("hands_off_reference.csv")
EVERY = 30
SIGNALS = (
    "time",
    "lateral_position",
    "yaw_angle",
    "steering_wheel_angle",
    "applied_torque",
    "lateral_error",
    "target_lateral_position",
)


def setups() -> dict[str, TrialSetup]:
    """Runs of 20 s: an offset, and lane changes strong and weak."""
    offset = hands_off_setup("default", 70.0 / 3.6, 20.0)._replace(
        initial_offset=OFFSET
    )
    change = hands_off_setup("default", 70.0 / 3.6, 20.0)._replace(trigger_times=(5.0,))
    rapid = hands_off_setup("compact", 110.0 / 3.6, 20.0)._replace(
        trigger_times=(5.0,), change_duration=4.0
    )
    return {
        "offset": offset,
        "normal change": change,
        "rapid change, compact car": rapid,
        "weak normal change": change._replace(strength_factor=0.4),
    }


def reference_rows() -> list[list[str | float]]:
    """Name of the run and signals, twice a second."""
    rows: list[list[str | float]] = []
    for name, setup in setups().items():
        columns = simulate_trial(setup).columns
        series = [columns[signal][::EVERY].tolist() for signal in SIGNALS]
        rows += [[name, *values] for values in zip(*series, strict=True)]
    return rows


def main() -> None:
    """Write the file."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(["run", *SIGNALS])
    for name, *values in reference_rows():
        writer.writerow([name, *(f"{float(value):.12g}" for value in values)])
    FILE.write_text(text.getvalue(), "utf-8")


if __name__ == "__main__":
    main()
