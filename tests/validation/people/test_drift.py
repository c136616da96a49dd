"""Spread, correlation time and spectrum of lane position."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from costeer.validation.people.drift import (
    WINDOW_SAMPLES,
    correlation_time,
    cut,
    drift,
    following_windows,
    frequencies,
    highway_windows,
    power_density,
)

TIME = np.arange(WINDOW_SAMPLES) / 10.0


def wave(frequency: float, amplitude: float = 0.2) -> np.ndarray:
    return amplitude * np.sin(2.0 * np.pi * frequency * TIME)


def test_frequencies_go_in_steps_of_a_window_to_1_hz() -> None:
    assert frequencies() == pytest.approx(np.arange(1, 21) * 0.05)


def test_a_wave_in_the_band_is_found_with_its_power() -> None:
    slow, fast = wave(0.05), wave(0.3, 0.1)
    found = drift(np.stack([fast, slow, slow + fast]))
    # The Hann window spreads a wave over three lines; none of 0.3 Hz leaves the band.
    assert found.fast[0] == pytest.approx(0.1 / np.sqrt(2.0), rel=1e-3)
    assert found.deviation[0] == pytest.approx(0.1 / np.sqrt(2.0), rel=3e-3)
    assert found.fast[2] > found.fast[0]
    assert frequencies()[np.argmax(found.density[0])] == pytest.approx(0.3)


def test_white_noise_has_a_flat_spectrum_of_its_variance() -> None:
    noise = np.random.default_rng(3).normal(0.0, 0.1, (400, WINDOW_SAMPLES))
    density = power_density(noise).mean(axis=0)
    # One-sided, 0.01 m² over 5 Hz; 400 windows leave 5 % per line, times three. The
    # first line loses some with the mean.
    assert density[1:] == pytest.approx(0.01 / 5.0, rel=0.15)


def test_a_wave_decorrelates_within_a_fifth_of_its_period() -> None:
    # cos(2 pi f t) = 1/e at 0.19 of the period; the sum over fewer pairs shortens it.
    period = 2.0
    assert correlation_time(wave(1.0 / period)) == pytest.approx(0.19 * period, abs=0.1)
    assert np.isnan(correlation_time(np.ones(WINDOW_SAMPLES)))


def test_the_spectrum_does_not_know_where_the_lane_is() -> None:
    window = wave(0.1)[None]
    assert power_density(window + 3.0) == pytest.approx(power_density(window))


def test_stretches_are_cut_into_whole_windows() -> None:
    position = np.arange(1000.0)
    good = np.ones(1000, bool)
    good[450] = False
    windows = cut(position, good)
    assert windows[:, 0].tolist() == [0.0, 200.0, 451.0, 651.0]
    position[100] = np.nan
    assert cut(position, good)[:, 0].tolist() == [101.0, 451.0, 651.0]


def write(path: Path, header: str, rows: list[str]) -> None:
    path.parent.mkdir(parents=True)
    path.write_text("\n".join([header, *rows]) + "\n")


def test_highway_windows_keep_clear_of_lane_changes_jumps_and_slow_driving(
    tmp_path: Path,
) -> None:
    rows = []
    for k in range(1800):
        decision = 2 if 300 <= k < 320 else 1
        speed = 14.0 if k >= 1500 else 20.0
        place = 0.001 * k + (0.5 if k >= 1000 else 0.0)
        rows.append(f"one,{k / 10.0},{speed},{place},{decision}")
    write(
        tmp_path / "r3_driving" / "expert.csv", "scenario,t,v,deviation,decision", rows
    )
    starts = (highway_windows(tmp_path)[:, 0] / 0.001).round().tolist()
    # 0 to 250 | change | 370 to 950 | jump | 1050 (0.5 m farther on) to 1499
    assert starts == [0.0, 369.0, 569.0, 1550.0, 1750.0]


def test_vehicles_of_the_film_are_not_joined(tmp_path: Path) -> None:
    rows = [f"{k // 300},{k % 300 / 10.0},{k}" for k in range(900)]
    write(tmp_path / "ngsim_i80_following" / "pairs.csv", "pair_id,time,local_x", rows)
    assert following_windows(tmp_path)[:, 0].tolist() == [0.0, 300.0, 600.0]


def test_absent_sets_have_no_windows(tmp_path: Path) -> None:
    for windows in (highway_windows(tmp_path), following_windows(tmp_path)):
        assert windows.shape == (0, WINDOW_SAMPLES)
        assert drift(windows).deviation.size == 0
        assert drift(windows).density.shape == (0, 20)
