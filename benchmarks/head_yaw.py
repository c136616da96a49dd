"""The webcam tracker on rendered faces: error, jitter, losses and time per picture.

    python -m benchmarks.head_yaw

Two face shapes, each held in three ways, turned by -60 to 60 deg in steps of 5. Each
face is calibrated once, held straight, by looks at 0, +30 and -30 deg, and moves
afterwards. A picture is judged by itself (the tracker starts anew), so that an error is
not hidden by the last angle being held. Time is measured with the face being followed.
"""

from __future__ import annotations

import math
import os
import time
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from benchmarks.speed.machine import load, processor_name
from costeer.devices.head import face, tracker
from costeer.devices.head.calibration import (
    FitParameters,
    HeadCalibration,
    Look,
    fit_calibration,
)
from costeer.devices.head.source import HeadDescription
from tests.devices.head.rendering import View, cabin, render

SHAPES = {"canonical": "mean face", "own": "portrait's own"}
HELD = {
    "straight": View(),
    "down, aside": View(pitch_deg=8.0, aside=0.06, distance=0.7),
    "up, rolled, low": View(pitch_deg=-8.0, roll_deg=5.0, below=0.04, distance=0.6),
}
ANGLES = np.arange(-60.0, 61.0, 5.0)
NOISE = 8.0
"""Standard deviation of the camera's noise, of 255."""

PARAMETERS = tracker.TrackerParameters()
Floats = NDArray[np.float64]


class Tracked(NamedTuple):
    """Yaw of one face held in one way, at `ANGLES`.

    Attributes:
        yaw: As tracked; NaN where it is not valid [deg].
        pictures: What the tracker saw.
    """

    yaw: Floats
    pictures: list[face.Image]


def tracked_yaw(networks: face.FaceNetworks, image: face.Image) -> float:
    """Yaw of one picture; NaN if it is not valid [deg]."""
    state = tracker.step(PARAMETERS, networks, tracker.initial_state(), image, 1 / 30)
    return math.degrees(state.head_yaw) if state.valid else math.nan


def turned(networks: face.FaceNetworks, shape: str, view: View) -> Tracked:
    """Render and track a face at all angles."""
    views = [view._replace(yaw_deg=float(angle)) for angle in ANGLES]
    pictures = [render(each, shape, seed) for seed, each in enumerate(views)]
    return Tracked(np.array([tracked_yaw(networks, p) for p in pictures]), pictures)


def calibration_of(straight: Floats) -> HeadCalibration:
    """From the three looks of a head that is held straight."""
    looks = [
        Look(math.radians(angle), math.radians(straight[angle == ANGLES].item()))
        for angle in (0.0, 30.0, -30.0)
    ]
    description = HeadDescription("webcam", "0")
    return fit_calibration(FitParameters(), "bench", description, looks)


def within(yaw: Floats, limit: float) -> str:
    """Mean and largest error of the valid angles up to a limit [deg]."""
    errors = np.abs(yaw - ANGLES)[np.abs(ANGLES) <= limit]
    return f"{np.nanmean(errors):5.2f} {np.nanmax(errors):5.1f}"


def print_errors(networks: face.FaceNetworks) -> None:
    """The table of errors."""
    print("error, mean and largest [deg]     before calibration        after")
    print("face            held             <= 30      <= 45      <= 30      <= 45")
    every: list[Floats] = []
    for shape, name in SHAPES.items():
        found = {held: turned(networks, shape, view) for held, view in HELD.items()}
        fitted = calibration_of(found["straight"].yaw)
        for held, each in found.items():
            after = fitted.gain * each.yaw + math.degrees(fitted.offset)
            every.append(after)
            cells = [within(y, limit) for y in (each.yaw, after) for limit in (30, 45)]
            print(f"{name:15} {held:15} {'  '.join(cells)}")
    print_summary(np.array(every))


def print_summary(after: Floats) -> None:
    """Errors and losses of all faces together."""
    for low, high in ((0, 30), (0, 45), (50, 60)):
        chosen = (np.abs(ANGLES) >= low) & (np.abs(ANGLES) <= high)
        errors = np.abs(after - ANGLES)[:, chosen]
        lost = np.mean(np.isnan(errors))
        print(
            f"{low} to {high} deg, all, calibrated: mean {np.nanmean(errors):.2f}, "
            f"95 % {np.nanpercentile(errors, 95):.1f} deg, not valid {100 * lost:.0f} %"
        )


def print_jitter(networks: face.FaceNetworks) -> None:
    """Spread of the yaw of a head that is still, under a camera's noise."""
    random = np.random.default_rng(1)
    for angle in (0.0, 25.0):
        still = render(View(yaw_deg=angle)).astype(float)
        state = tracker.initial_state()
        yaw = []
        for _ in range(60):
            noisy = still + random.normal(0.0, NOISE, still.shape)
            image = np.clip(noisy, 0, 255).astype(np.uint8)
            state = tracker.step(PARAMETERS, networks, state, image, 1 / 30)
            yaw.append(math.degrees(state.head_yaw))
        print(f"jitter at {angle:.0f} deg, noise 8 of 255: {np.std(yaw):.2f} deg")


def print_times(networks: face.FaceNetworks) -> None:
    """Time per picture: face followed, and no face to be found."""
    turning = [render(View(yaw_deg=30.0 * math.sin(k / 5.0))) for k in range(32)]
    for name, pictures in {"followed": turning, "no face": [cabin()]}.items():
        state = tracker.initial_state()
        walls, spent = [], []
        for image in pictures * (320 // len(pictures)):
            wall, own = time.perf_counter(), time.process_time()
            state = tracker.step(PARAMETERS, networks, state, image, 1 / 30)
            walls.append(1e3 * (time.perf_counter() - wall))
            spent.append(1e3 * (time.process_time() - own))
        p50, p95 = np.percentile(walls, [50, 95])
        print(
            f"{name}: p50 {p50:.1f} ms, p95 {p95:.1f} ms a picture, of one core "
            f"{np.mean(spent):.1f} ms: {1e3 / np.mean(spent):.0f} pictures a second"
        )


def main() -> None:
    """Print everything."""
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})
    print(f"{processor_name()}, one core, load {load()}")
    networks = face.load_networks()
    print_errors(networks)
    print_jitter(networks)
    print_times(networks)


if __name__ == "__main__":
    main()
