"""How well the observer tells the driver's torque, and the self-test the wheel.

    python -m benchmarks.torque_observer [--data FOLDER]

Simulated devices are drawn, calibrated, and held against the truth. Each then drives a
trial with the torque that a virtual driver had and some stiffness besides; the observer
sees the angle alone. Last, a real car, its column identified on another part.
"""

from __future__ import annotations

import argparse
import csv
import gzip
import os
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from benchmarks.column_fit import fit_column
from costeer.controller.actuation import STRONG
from costeer.devices.wheels.calibration import (
    WheelCalibration,
    observer_parameters,
    uncalibrated,
)
from costeer.devices.wheels.selftest import Reference, calibrate, run_procedure
from costeer.devices.wheels.simulated import (
    SimulatedWheel,
    SimulatedWheelParameters,
    true_calibration,
)
from costeer.loop.scenario import PILOT_SEED, TrialSetup
from costeer.loop.trial import simulate_trial
from costeer.plant.parameters import ColumnParameters
from costeer.sensing.torque_observer import (
    TorqueObserverParameters,
    TorqueObserverState,
    WheelMotion,
    initial_state,
    step,
)

NUM_DEVICES, NUM_DRIVERS = 100, 12
DT = 1.0 / 960.0
PART = 60.0  # driven of each trial [s]

Signal = NDArray[np.float64]


def drawn(random: np.random.Generator) -> SimulatedWheelParameters:
    """A device from weak and light to strong and stiff."""
    peak = float(random.uniform(1.5, 6.0))
    power, dead = float(random.uniform(0.7, 1.4)), float(random.choice([0.0, 0.03]))
    levels = [0.05 * n for n in range(21)]
    shares = [max((c - dead) / (1.0 - dead), 1e-6 * c) ** power for c in levels]
    return SimulatedWheelParameters(
        inertia=0.02 * 5.0 ** float(random.random()),
        damping=float(random.uniform(0.01, 0.4)),
        friction=float(random.uniform(0.05, 0.5)) * min(1.0, peak / 3.0),
        torque_curve=tuple((c, peak * s) for c, s in zip(levels, shares, strict=True)),
        angle_sign=float(random.choice([-1.0, 1.0])),
        torque_sign=float(random.choice([-1.0, 1.0])),
        latency=int(random.integers(2, 30)),
    )


def found(device: SimulatedWheelParameters) -> WheelCalibration:
    """What the self-test says of a device."""
    raw = uncalibrated("simulated", device.full_range, device.angle_sign)
    reference = Reference(peak_torque=device.torque_curve[-1][1], turns=False)
    procedure = calibrate(raw, reference, DT)
    wheel = SimulatedWheel(device, raw)
    return run_procedure(wheel, procedure, lambda: None, lambda text: None).calibration


def print_errors(
    devices: list[SimulatedWheelParameters], calibrations: list[WheelCalibration]
) -> None:
    """Median and worst error of each value of the calibrations."""
    rows = []
    for device, known in zip(devices, calibrations, strict=True):
        truth = true_calibration(device)
        commands, torques = zip(*truth.torque_curve, strict=True)
        curve = max(
            abs(torque - float(np.interp(command, commands, torques)))
            for command, torque in known.torque_curve
        )
        rows.append(
            (
                abs(known.inertia / truth.inertia - 1.0),
                abs(known.damping - truth.damping),
                abs(known.friction - truth.friction),
                1e3 * abs(known.latency - truth.latency),
                curve / torques[-1],
                float(known.torque_sign != truth.torque_sign),
            )
        )
    names = (
        "inertia [1]",
        "damping [N·m·s/rad]",
        "friction [N·m]",
        "latency [ms]",
        "torque, of the largest [1]",
        "wrong sign [1]",
    )
    print(f"self-test on {len(devices)} simulated devices: error, median and worst")
    for name, errors in zip(names, np.array(rows).T, strict=True):
        print(f"  {name:28s} {np.median(errors):8.4f} {errors.max():8.4f}")


class Driven(NamedTuple):
    """A trial of a virtual driver at 960 Hz: torques [N·m], angle and its rate."""

    driver: Signal
    guidance: Signal
    angle: Signal
    rate: Signal


def driven(participant: int) -> Driven:
    """The first part of a pilot driver's trial with strong guidance."""
    setup = TrialSetup(
        participant=participant,
        seed=PILOT_SEED,
        condition="strong",
        strength_factor=STRONG,
        change_duration=6.0,
        intention="scripted",
    )
    columns = simulate_trial(setup).columns
    time = np.asarray(columns["time"], np.float64)
    fine = np.arange(time[0], min(time[-1], time[0] + PART), DT)
    names = (
        "driver_torque",
        "applied_torque",
        "steering_wheel_angle",
        "steering_wheel_rate",
    )
    return Driven(
        *(np.interp(fine, time, np.asarray(columns[n], np.float64)) for n in names)
    )


class Judged(NamedTuple):
    """An estimate beside the truth.

    Attributes:
        error: Root mean square of the difference [N·m].
        correlation: At the best delay [-].
        delay: Of the estimate, where the correlation is best [s].
        delayed_error: Error against the truth that much earlier [N·m].
        size: Root mean square of the truth [N·m].
    """

    error: float
    correlation: float
    delay: float
    delayed_error: float
    size: float


def judged(estimate: Signal, truth: Signal, dt: float, longest: float) -> Judged:
    """Hold an estimate against the truth, also shifted by up to `longest` [s]."""
    shifts = range(0, round(longest / dt) + 1, max(round(0.002 / dt), 1))
    size = truth.size

    def correlation(shift: int) -> float:
        pair = np.corrcoef(estimate[shift:], truth[: size - shift])
        return float(pair[0, 1])

    best = max(shifts, key=correlation)
    late = estimate[best:] - truth[: size - best]
    return Judged(
        error=float(np.sqrt(np.mean((estimate - truth) ** 2))),
        correlation=correlation(best),
        delay=best * dt,
        delayed_error=float(np.sqrt(np.mean(late**2))),
        size=float(np.sqrt(np.mean(truth**2))),
    )


class Hands:
    """A virtual driver's torque of a trial, and stiffness that keeps to its angle."""

    def __init__(self, drive: Driven) -> None:
        self._drive = drive
        self.index = 0
        self.torques = np.zeros(drive.driver.size)

    def __call__(self, time: float, angle: float, rate: float) -> float:
        """Torque of the hands [N·m]."""
        i = min(self.index, self.torques.size - 1)
        drive = self._drive
        torque = float(
            drive.driver[i]
            + 6.0 * (drive.angle[i] - angle)
            + 0.6 * (drive.rate[i] - rate)
        )
        self.torques[i] = torque
        self.index += 1
        return torque


class Watched(NamedTuple):
    """What an observer may see of a device that is held, and the truth.

    Attributes:
        motions: Angle [rad] and the motor's torque [N·m], shape `(time, 2)`.
        hands: Torque of the hands [N·m].
    """

    motions: Signal
    hands: Signal


def watched(device: SimulatedWheelParameters, participant: int) -> Watched:
    """A device held by a virtual driver; its motor makes the column of costeer."""
    drive = driven(participant)
    hands = Hands(drive)
    wheel = SimulatedWheel(device, true_calibration(device), hands)
    column = ColumnParameters()
    motions = np.zeros((drive.driver.size, 2))
    motor = rate = last = 0.0
    for i, guidance in enumerate(drive.guidance.tolist()):
        wheel.write(motor)
        angle = wheel.read().steering_wheel_angle
        motions[i] = angle, motor
        rate += ((angle - last) / DT - rate) * 0.1  # a lag of 10 ms
        last = angle
        # Of the column's damping the device and its latency bear half.
        asked = guidance - column.stiffness * angle - 0.5 * rate
        motor = max(-wheel.torque_limit, min(wheel.torque_limit, asked))
    return Watched(motions, hands.torques)


@njit
def estimates(
    parameters: TorqueObserverParameters,
    state: TorqueObserverState,
    motions: Signal,
    dt: float,
) -> Signal:
    """What the observer says at each reading of angle and motor torque [N·m]."""
    seen = np.empty(len(motions))
    for i in range(len(motions)):
        motion = WheelMotion(motions[i, 0], np.nan, motions[i, 1])
        state, seen[i] = step(parameters, state, motion, dt)
    return seen


def wrong_by(factor: float, known: WheelCalibration) -> TorqueObserverParameters:
    """An observer whose device is wrong by a factor."""
    right = observer_parameters(known)
    return right._replace(
        inertia=factor * right.inertia,
        damping=factor * right.damping,
        friction=factor * right.friction,
        latency=factor * right.latency,
    )


def print_row(name: str, all_judged: list[Judged]) -> None:
    """Medians over trials, and the worst error."""
    error, correlation, delay, late, size = np.median(np.array(all_judged), axis=0)
    worst = max(each.error for each in all_judged)
    print(
        f"  {name:24s} {size:6.3f} {error:6.3f} {worst:6.3f} {late:6.3f}"
        f" {correlation:6.3f} {1e3 * delay:6.1f}"
    )


HEADING = (
    "                             rms  error  worst  late*  corr*  delay [ms]\n"
    "  (rms and errors in N·m; * at the best delay)"
)


def print_trials(
    devices: list[SimulatedWheelParameters], calibrations: list[WheelCalibration]
) -> None:
    """The observer on devices held by virtual drivers."""
    results: dict[str, list[Judged]] = {}
    with ProcessPoolExecutor(2) as pool:
        drives = pool.map(watched, devices[:NUM_DRIVERS], range(1, NUM_DRIVERS + 1))
        held = list(drives)
    for n, (motions, hands) in enumerate(held):
        truth = true_calibration(devices[n])
        right = observer_parameters(truth)
        observers = {
            "true parameters": right,
            "as the self-test found": observer_parameters(calibrations[n]),
            "20 % too small": wrong_by(0.8, truth),
            "20 % too large": wrong_by(1.2, truth),
            "no friction known": right._replace(friction=0.0),
        }
        for name, observer in observers.items():
            seen = estimates(observer, initial_state(), motions, DT)
            results.setdefault(name, []).append(judged(seen, hands, DT, 0.15))
    print(f"\nobserver, {NUM_DRIVERS} devices and virtual drivers, {PART:.0f} s each")
    print(HEADING)
    for name, each in results.items():
        print_row(name, each)
    print("  each device as the self-test found it, by its friction [N·m]")
    frictions = [device.friction for device in devices[:NUM_DRIVERS]]
    for n in np.argsort(frictions):
        print_row(f"  {frictions[n]:.2f}", [results["as the self-test found"][n]])


class Part(NamedTuple):
    """A stretch of the real recording at an even rate."""

    name: str
    angle: Signal
    torque: Signal


def real_parts(file: Path, slowest: float = 12.0) -> list[Part]:
    """Both drives, even at 20 Hz, where the car was faster than `slowest` [m/s]."""
    with gzip.open(file, "rt", encoding="utf-8") as text:
        rows = [tuple(map(float, row)) for row in list(csv.reader(text))[1:]]
    table, parts = np.array(rows), []
    for number in np.unique(table[:, 0]):
        part = table[table[:, 0] == number]
        time = np.arange(part[0, 1], part[-1, 1], 0.05)
        angle, torque, speed = (
            np.interp(time, part[:, 1], part[:, column]) for column in (2, 3, 4)
        )
        fast = speed > slowest
        parts.append(Part(f"part {number:.0f}", angle[fast], torque[fast]))
    return parts


def real_estimate(column: TorqueObserverParameters, part: Part) -> Signal:
    """What the observer says of a recording without a motor [N·m]."""
    observer = column._replace(
        time_constant=0.1, rate_time_constant=0.05, still_rate=0.05
    )
    motions = np.column_stack([part.angle, np.zeros_like(part.angle)])
    return estimates(observer, initial_state(float(part.angle[0])), motions, 0.05)


def print_real(folder: Path) -> None:
    """The observer on a real car, identified on one part and judged on another."""
    file = folder / "udacity_steering" / "ch2_20hz.csv.gz"
    if not file.is_file():
        print(f"\nudacity_steering is not in {folder}: give --data FOLDER")
        return
    whole = real_parts(file)
    halves = [
        Part(f"{p.name}, {name} half", p.angle[cut], p.torque[cut])
        for p in whole
        for middle in [p.angle.size // 2]
        for name, cut in {"1st": slice(middle), "2nd": slice(middle, None)}.items()
    ]
    pairs = [(whole[0], whole[1]), (whole[1], whole[0])]
    pairs += [(halves[i], halves[i + 1]) for i in (0, 2)]
    print(
        "\nreal car, 20 Hz: column identified on one part, judged on another",
        HEADING,
        sep="\n",
    )
    for source, target in pairs:
        fit = fit_column(source.angle, source.torque, 0.05)
        seen = real_estimate(fit.parameters, target) + fit.offset
        print(f"  {source.name}: {words(fit.parameters)}, R² {fit.explained:.2f}")
        print_row(f"  on {target.name}", [judged(seen, target.torque, 0.05, 0.5)])
        spring = TorqueObserverParameters(0.0, 0.0, fit.parameters.stiffness, 0.0)
        seen = real_estimate(spring, target) + fit.offset
        print_row("  stiffness alone", [judged(seen, target.torque, 0.05, 0.5)])


def words(of: TorqueObserverParameters) -> str:
    """A column in short."""
    spring = f"K {of.stiffness:.2f} N·m/rad, B {of.damping:.2f} N·m·s/rad"
    return f"{spring}, J {of.inertia:.3f} kg·m², friction {of.friction:.2f} N·m"


def main() -> None:
    """Print the three parts."""
    parser = argparse.ArgumentParser(description=__doc__)
    data = Path(os.environ.get("COSTEER_DATA", "../shared/data"))
    parser.add_argument("--data", type=Path, default=data)
    parser.add_argument("--devices", type=int, default=NUM_DEVICES)
    arguments = parser.parse_args()
    random = np.random.default_rng(2)
    devices = [drawn(random) for _ in range(max(arguments.devices, NUM_DRIVERS))]
    with ProcessPoolExecutor(2) as pool:
        calibrations = list(pool.map(found, devices))
    print_errors(devices, calibrations)
    print_trials(devices, calibrations)
    print_real(arguments.data)


if __name__ == "__main__":
    main()
