"""Figures of a drive say what the numbers say, and which budget was kept."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks.speed.pace import Kept, Material, figures, measure_drive
from costeer.runtime.frame import FRAME_COLUMNS, PLACE, TRACE_COLUMNS


def material(late: float = 0.0, compute: float = 1e-4, age: float = 0.01) -> Material:
    """A thousand frames; one plant step in a hundred is `late` [s]."""
    frames = np.zeros((1000, len(FRAME_COLUMNS)))
    frames[:, PLACE["compute_time"]] = compute
    trace = np.zeros((16_000, len(TRACE_COLUMNS)))
    trace[::100, TRACE_COLUMNS.index("lateness")] = late
    trace[:, TRACE_COLUMNS.index("step_time")] = 2e-4
    return Material(
        frames=frames,
        trace=trace,
        arrivals=np.arange(1000) / 60.0,
        ages=np.full(1000, age),
        page={"fps": 12.0},
        priority="SCHED_FIFO 60",
    )


def by_name(found: list[Kept]) -> dict[str, Kept]:
    return {each.name: each for each in found}


def test_everything_kept_is_told_as_kept() -> None:
    found = by_name(figures(material()))
    assert all("NOT" not in each.verdict for each in found.values())
    assert found["frames a second at the server"].value == pytest.approx(60.0)
    assert found["torque command to device, 99 %"].value == pytest.approx(0.3)
    assert found["frames drawn a second, 640x360"].value == 12.0


def test_movement_waits_for_the_next_frame_besides() -> None:
    # A uniform wait of up to 16.7 ms on top of a constant age: 95 % is at 0.95 of it.
    found = by_name(figures(material(age=0.01)))
    expected = 10.0 + 0.95 * 1000.0 / 60.0
    assert found["movement to page, 95 %"].value == pytest.approx(expected, abs=0.2)


@pytest.mark.parametrize(
    ("given", "name"),
    [
        (material(late=0.002), "steps over a period late"),
        (material(compute=0.0011), "control step, computing, 99.9 %"),
        (material(age=0.02), "movement to page, 95 %"),
    ],
    ids=["late", "slow", "old"],
)
def test_what_is_not_kept_is_told(given: Material, name: str) -> None:
    broken = [each.name for each in figures(given) if "NOT" in each.verdict]
    assert broken == [name]


def test_share_of_late_steps_counts_a_whole_period() -> None:
    found = by_name(figures(material(late=0.00103)))
    assert found["steps over a period late"].value == 0.0
    found = by_name(figures(material(late=0.00105)))
    assert found["steps over a period late"].value == pytest.approx(1.0)


def test_without_priority_lateness_is_told_and_not_judged() -> None:
    weak = material(late=0.002)._replace(priority="SCHED_FIFO is not permitted")
    found = by_name(figures(weak))
    assert found["steps over a period late"].verdict == "no priority"


def test_without_a_page_nothing_is_said_of_one() -> None:
    found = by_name(figures(material()._replace(ages=np.array([]), page={})))
    assert not [name for name in found if "page" in name]


@pytest.mark.slow
@pytest.mark.usefixtures("compiled_drive")
def test_a_real_drive_gives_every_figure_but_those_of_a_page() -> None:
    # How many steps two seconds hold is for the benchmark to judge, not for a machine
    # that does other things besides.
    found = by_name(figures(measure_drive(2.0, "")))
    assert (
        found.keys()
        == by_name(figures(material()._replace(ages=np.array([]), page={}))).keys()
    )
    assert found["plant steps"].value > 100
    assert 0.0 < found["frames a second at the server"].value < 61.0
