"""The numbers of a window against the window itself."""

from __future__ import annotations

import numpy as np
import pytest

from costeer.intention.features import FEATURES
from costeer.intention.predictors.summary import (
    CHANNELS,
    STATISTICS,
    bounded,
    channels_of,
    summary,
    summary_names,
)
from tests.intention.predictors.made import MEAN, SCALE, features


def test_statistics_are_those_of_the_last_samples() -> None:
    seen = features(300, 1)
    numbers = summary(seen, FEATURES)
    names = summary_names(FEATURES)
    assert numbers.shape == (300, len(names))
    speed = seen[:, 2]
    for end in (179, 240, 299):
        window = speed[end - 179 : end + 1]
        second = window[-60:]
        expected = {
            "last": window[-1],
            "mean_half": window[-30:].mean(),
            "mean_one": second.mean(),
            "mean": window.mean(),
            "lowest": window.min(),
            "highest": window.max(),
            "slope": np.polyfit(np.arange(60) / 60.0, second, 1)[0],
        }
        for statistic in STATISTICS:
            column = names.index(f"longitudinal_velocity {statistic}")
            assert numbers[end, column] == pytest.approx(expected[statistic])


def test_geometry_follows_from_the_signals() -> None:
    seen = np.tile(MEAN, (200, 1))
    seen[:, 5] = -0.02
    by_name = dict(
        zip(summary_names(FEATURES), summary(seen, FEATURES)[-1], strict=True)
    )
    approach = 20.0 * np.sin(0.02)
    assert by_name["approach_velocity mean"] == pytest.approx(approach)
    after = 1.75 - 3.0 * approach
    assert by_name["distance_after_three last"] == pytest.approx(after)
    assert by_name["inverse_line_time highest"] == pytest.approx(approach / 1.75)


def test_channels_need_their_signals() -> None:
    assert set(channels_of(FEATURES)) == set(CHANNELS)
    assert channels_of(("head_yaw",)) == ("head_yaw",)
    motion = channels_of(("longitudinal_velocity", "yaw_angle"))
    assert "approach_velocity" in motion
    assert "inverse_line_time" not in motion


def test_bounds_hold_and_missing_is_the_mean() -> None:
    seen = np.array([[np.nan, np.inf, -1e9, 0.0, 1.0, 0.0]])
    held = bounded(seen, MEAN, SCALE)[0]
    assert held[0] == MEAN[0]
    assert held[1] == pytest.approx(MEAN[1] + 10.0 * SCALE[1])
    assert held[2] == pytest.approx(MEAN[2] - 10.0 * SCALE[2])
    np.testing.assert_allclose(held[3:], seen[0, 3:])
