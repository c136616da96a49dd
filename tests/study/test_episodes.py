"""What is shown of a study is chosen by a rule."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from costeer.controller.strength import StrengthParameters, initial_state, step
from costeer.pages.style import styled
from costeer.records.record import TrialRecord, read_record, write_record
from costeer.study.figures import gain, inconsistency
from costeer.study.figures.episodes import (
    LONGEST_TAIL,
    exemplary_inconsistency,
    falls,
    inconsistent_spans,
    rises,
)
from costeer.study.material import StudyMaterial, replan_gain

REPLAN_GAIN = 0.05

Records = dict[tuple[int, str], Path]


def test_rises_and_falls_come_in_pairs() -> None:
    flags = np.array([True, False, True, True, False, True])
    assert rises(flags).tolist() == [0, 2, 5]
    assert falls(flags).tolist() == [0, 3, 5]


def test_the_first_that_was_triggered_replanned_and_recovered_is_shown(
    material: StudyMaterial,
) -> None:
    episode = exemplary_inconsistency(material.records, REPLAN_GAIN)
    assert episode is not None
    assert (episode.participant, episode.condition) == (1, "strong-rapid")
    assert episode.trigger < episode.onset < episode.recovery
    assert episode.lowest_gain < REPLAN_GAIN
    time = episode.columns["time"]
    assert time[0] < episode.trigger
    assert time[-1] > episode.recovery


def changed(records: Records, folder: Path, **columns: np.ndarray) -> Records:
    """One record with other columns in place of its own."""
    record = read_record(records[1, "strong-rapid"])
    path = folder / "changed.parquet"
    write_record(path, TrialRecord(record.metadata, {**record.columns, **columns}))
    return {(1, "strong-rapid"): path}


def columns_of(records: Records) -> dict[str, np.ndarray]:
    return dict(read_record(records[1, "strong-rapid"]).columns)


def test_without_a_trigger_or_recovery_the_nearest_is_shown(
    material: StudyMaterial, tmp_path: Path
) -> None:
    columns = columns_of(material.records)
    lost = columns["haptic_gain"].copy()
    first = int(np.flatnonzero(~np.ma.filled(columns["consistent"], True))[0])
    lost[first:] = 0.5
    records = changed(
        material.records,
        tmp_path,
        intention=np.zeros(lost.size, bool),
        haptic_gain=lost,
    )
    episode = exemplary_inconsistency(records, REPLAN_GAIN)
    assert episode is not None
    assert np.isnan(episode.trigger)
    assert np.isnan(episode.recovery)
    assert episode.columns["time"][-1] <= episode.onset + LONGEST_TAIL + 2.1
    with styled():
        caption = inconsistency.draw(episode).caption
    assert "no trigger preceded it within 8 s" in caption
    assert "the gain was not back" in caption


def test_a_verdict_of_a_single_row_is_shaded_too(material: StudyMaterial) -> None:
    episode = exemplary_inconsistency(material.records, REPLAN_GAIN)
    assert episode is not None
    time = episode.columns["time"]
    consistent = np.ones(time.size, bool)
    consistent[[10, 20, 21, 22, -1]] = False
    flipping = episode._replace(columns={**episode.columns, "consistent": consistent})
    spans = [(10, 11), (20, 23), (-1, -1)]
    assert inconsistent_spans(flipping.columns) == [
        (time[a], time[b]) for a, b in spans
    ]
    with styled():
        figure = gain.draw(flipping, REPLAN_GAIN).figure
    assert figure is not None
    shades = [patch.get_x() for patch in figure.axes[1].patches]
    assert shades == pytest.approx([time[a] - episode.onset for a, _ in spans])


def test_a_study_in_which_all_agree_shows_the_law_alone(
    material: StudyMaterial, tmp_path: Path
) -> None:
    agreeing = np.ma.MaskedArray(
        np.ones(columns_of(material.records)["time"].size, bool), mask=False
    )
    records = changed(material.records, tmp_path, consistent=agreeing)
    assert exemplary_inconsistency(records, REPLAN_GAIN) is None
    with styled():
        exhibit = gain.draw(None, REPLAN_GAIN)
    assert "No fade was recorded" in exhibit.caption
    assert inconsistency.draw(None).missing


def test_the_law_drawn_is_the_one_that_the_controller_steps_through() -> None:
    dt = 1 / 60
    state, stepped = initial_state(), []
    for number in range(480):
        state, value = step(StrengthParameters(), state, not 1 <= number < 61, dt)
        stepped.append(value)
    # The verdict turns at the step after 0 s; until then the gain is 1.
    time = dt * (np.arange(480) - 1)
    drawn = gain.gain_over(time, 0.0, 1.0)
    # A step keeps the gain of the step before the switch: the gain falls by at most
    # λ/2 per second, and the tanh restarts 3.4e-4 off ("approximately equal").
    assert drawn == pytest.approx(np.array(stepped), abs=2.0 * dt + 4e-4)
    # Before the switch there is no such difference.
    assert drawn[:61] == pytest.approx(np.array(stepped[:61]), abs=4e-4)


def test_the_gain_to_replan_at_is_the_records_own(material: StudyMaterial) -> None:
    metadata = ({"replan_gain": None}, {"replan_gain": 0.1})
    assert replan_gain(material._replace(metadata=metadata)) == 0.1
    assert replan_gain(material._replace(metadata=())) == REPLAN_GAIN


def test_lines_are_told_apart_without_colour(material: StudyMaterial) -> None:
    episode = exemplary_inconsistency(material.records, REPLAN_GAIN)
    assert episode is not None
    with styled():
        figure = inconsistency.draw(episode).figure
    assert figure is not None
    for panel in figure.axes:
        lines, _ = panel.get_legend_handles_labels()
        styles = [line.get_linestyle() for line in lines]
        assert len(styles) == len(set(styles))
