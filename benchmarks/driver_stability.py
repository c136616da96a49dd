"""Whether virtual drivers swing or leave the road, over a population.

    python -m benchmarks.driver_stability [DRIVERS]

Prints, for 1000 drivers of one seed in the default car at 70 km/h and for a smaller
sample in all cars at 50 to 110 km/h: least damping ratio of the linear loop with its
frequency and its driver, longest settling of an offset of 0.5 m and largest ratio of
successive swings, both beyond what the driver lets go, amplitude of the hunting without
noise, and least distance of a wheel from the road's outer lines in a manual trial. Exit
code 1 if a driver swings or leaves the road.
"""

from __future__ import annotations

import sys

import numpy as np

from costeer.drivers.population import participant_driver
from costeer.validation.stability import (
    Stability,
    driver_stability,
    every_stability,
    leaves_road,
    oscillates,
)

SEED = 131
NUM_DRIVERS = 1000
NUM_ELSEWHERE = 30

HEADER = (
    "car      km/h  drivers  damping  at rad/s  driver  modulus  settle s  swings  "
    "hunting m  edge m  over line  swing  off road"
)


def line(found: Stability) -> str:
    """One car at one speed."""
    worst = int(found.damping_ratio.argmin())
    return (
        f"{found.car:8s} {found.speed * 3.6:4.0f} {len(found.damping_ratio):8d} "
        f"{found.damping_ratio[worst]:8.2f} {found.frequency[worst]:9.1f} "
        f"{worst + 1:7d} {found.largest_modulus.max():8.4f} "
        f"{found.settling_time.max():9.2f} {found.swing_ratio.max():7.2f} "
        f"{np.median(found.hunting):10.3f} {found.edge_margin.min():7.2f} "
        f"{np.count_nonzero(found.edge_margin < 0.0):10d} "
        f"{np.count_nonzero(oscillates(found)):6d} "
        f"{np.count_nonzero(leaves_road(found)):9d}"
    )


def main() -> int:
    """Print the table and the least damped driver; return the exit code."""
    number = int(sys.argv[1]) if len(sys.argv) > 1 else NUM_DRIVERS
    print("python -m benchmarks.driver_stability")
    print(f"drivers of seed {SEED}\n{HEADER}")
    every = [driver_stability(SEED, number)]
    print(line(every[0]), flush=True)
    every += every_stability(SEED, min(NUM_ELSEWHERE, number))
    for found in every[1:]:
        print(line(found))
    worst = int(every[0].damping_ratio.argmin()) + 1
    driver = participant_driver(SEED, worst, every[0].speed)
    print(f"least damped at 70 km/h: driver {worst}, {driver.arm}")
    return int(any(oscillates(f).any() or leaves_road(f).any() for f in every))


if __name__ == "__main__":
    sys.exit(main())
