"""Figures that one would print: labelled, legible, whole."""

from __future__ import annotations

import csv
import io
import math
import re
from collections.abc import Sequence

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import to_rgb
from matplotlib.text import Text
from matplotlib.ticker import FixedFormatter, FuncFormatter

from costeer.methods.conditions import CONDITION_NAMES
from costeer.pages import series
from costeer.pages.exhibit import Exhibit
from costeer.pages.publish import published
from costeer.pages.style import (
    COLUMN_WIDTH_MM,
    FULL_WIDTH_MM,
    MM_PER_INCH,
    SMALL,
    STRENGTH_LINES,
    styled,
    svg_text,
)
from costeer.study.figures import (
    bars,
    detection,
    forest,
    signals,
    trajectories,
    workload,
)
from costeer.study.figures.catalogue import FIGURE_NAMES
from costeer.study.figures.colours import condition_colour
from costeer.study.material import StudyMaterial
from costeer.study.quantities import QUANTITIES, WORKLOAD

pytestmark = pytest.mark.slow
UNIT = re.compile(r"\[[^\]]+\]")


def drawn(exhibits: Sequence[Exhibit]) -> list[Exhibit]:
    return [each for each in exhibits if each.figure is not None]


def panels(exhibit: Exhibit) -> list[Axes]:
    assert exhibit.figure is not None
    return list(exhibit.figure.axes)


def shows_numbers(axis: Axis, labelled: str) -> bool:
    """Whether an axis has numbers at its ticks, not words and not nothing."""
    words = isinstance(axis.get_major_formatter(), (FixedFormatter, FuncFormatter))
    return bool(axis.get_tick_params()[labelled]) and not words


def test_everything_the_paper_shows_is_drawn_but_workload(
    exhibits: list[Exhibit],
) -> None:
    of_people = {bars.file_name(each) for each in WORKLOAD}
    of_people |= {"workload-items", "agreement", "traffic"}
    assert {each.name for each in drawn(exhibits)} == set(FIGURE_NAMES) - of_people


def test_every_axis_with_numbers_names_its_unit(exhibits: list[Exhibit]) -> None:
    for exhibit in drawn(exhibits):
        for panel in panels(exhibit):
            if shows_numbers(panel.xaxis, "labelbottom"):
                assert UNIT.search(panel.get_xlabel()), (exhibit.name, "x")
            if shows_numbers(panel.yaxis, "labelleft"):
                assert UNIT.search(panel.get_ylabel()), (exhibit.name, "y")


def test_every_figure_has_the_width_of_a_column_or_a_page(
    exhibits: list[Exhibit],
) -> None:
    for exhibit in drawn(exhibits):
        assert exhibit.figure is not None
        width = exhibit.figure.get_figwidth() * MM_PER_INCH
        assert min(abs(width - w) for w in (COLUMN_WIDTH_MM, FULL_WIDTH_MM)) < 1e-6


def texts(exhibit: Exhibit) -> list[Text]:
    assert exhibit.figure is not None
    found = exhibit.figure.findobj(Text)
    return [each for each in found if each.get_visible() and each.get_text()]


def test_no_text_is_smaller_than_can_be_read(exhibits: list[Exhibit]) -> None:
    for exhibit in drawn(exhibits):
        assert min(each.get_fontsize() for each in texts(exhibit)) >= SMALL


@pytest.mark.slow
def test_no_text_leaves_its_figure(exhibits: list[Exhibit]) -> None:
    for exhibit in drawn(exhibits):
        assert exhibit.figure is not None
        canvas = FigureCanvasAgg(exhibit.figure)
        exhibit.figure.draw_without_rendering()
        whole = exhibit.figure.bbox
        for text in texts(exhibit):
            box = text.get_window_extent(canvas.get_renderer())
            inside = box.x0 >= -1 and box.x1 <= whole.x1 + 1  # one pixel of rounding
            inside &= box.y0 >= -1 and box.y1 <= whole.y1 + 1
            # Ticks beyond the limits keep their text but are not drawn.
            assert inside or text not in shown_texts(exhibit), text.get_text()


def shown_texts(exhibit: Exhibit) -> list[Text]:
    """All texts but those of ticks outside the range of their axis."""
    hidden: list[Text] = []
    for panel in panels(exhibit):
        for axis, limits in (
            (panel.xaxis, panel.get_xlim),
            (panel.yaxis, panel.get_ylim),
        ):
            low, high = sorted(limits())
            for tick in axis.get_major_ticks():
                if not low - 1e-9 <= tick.get_loc() <= high + 1e-9:
                    hidden += [tick.label1, tick.label2]
    return [each for each in texts(exhibit) if each not in hidden]


def test_every_figure_is_described_for_those_who_do_not_see_it(
    exhibits: list[Exhibit],
) -> None:
    for exhibit in drawn(exhibits):
        assert exhibit.title
        assert exhibit.caption.endswith(".")
        assert exhibit.description.endswith(".")


@pytest.mark.slow
def test_a_style_of_the_user_changes_nothing(material: StudyMaterial) -> None:
    import matplotlib as mpl

    def text() -> str:
        with styled():
            exhibit = bars.draw(material, QUANTITIES[0])
            assert exhibit.figure is not None
            return svg_text(exhibit.figure, exhibit.name, exhibit.title)

    plain = text()
    with mpl.rc_context({"font.size": 20.0, "axes.facecolor": "red"}):
        assert text() == plain


def test_no_two_conditions_share_a_colour_nor_a_grey() -> None:
    # Rec. 709 luma; 0.02 is about the least step that print keeps apart.
    colours = [to_rgb(condition_colour(name)) for name in CONDITION_NAMES]
    assert len(set(colours)) == len(CONDITION_NAMES)
    for strength in ("strong", "weak"):
        shades = [
            np.dot((0.2126, 0.7152, 0.0722), to_rgb(condition_colour(name)))
            for name in CONDITION_NAMES
            if name.startswith(strength)
        ]
        assert np.all(np.diff(shades) > 0.02)


def test_every_bar_stands_on_zero_and_is_as_high_as_the_mean(
    material: StudyMaterial, exhibits: list[Exhibit]
) -> None:
    by_name = {each.name: each for each in exhibits}
    for quantity in QUANTITIES:
        panel = panels(by_name[bars.file_name(quantity)])[-1]
        table = getattr(material, quantity.table)
        own = table.groupby(["condition", "participant"])[quantity.name].mean()
        means = own.groupby(level=0).mean() * quantity.factor
        heights = [bar.get_height() for bar in panel.patches]
        assert heights == pytest.approx([means[name] for name in CONDITION_NAMES])
        assert panel.get_ylim()[0] == 0.0


@pytest.mark.slow
def test_an_interval_that_is_cut_at_zero_is_told(material: StudyMaterial) -> None:
    (sdlp,) = (each for each in QUANTITIES if each.name == "sdlp")
    cut = "Intervals that reach below zero are cut at zero."
    rows = material.tests.summaries
    below = [r._replace(low=-0.1, high=2 * r.mean + 0.1) for r in rows]
    above = [r._replace(low=0.9 * r.mean, high=1.1 * r.mean) for r in rows]
    for changed, told in ((below, True), (above, False)):
        study = material._replace(
            tests=material.tests._replace(summaries=tuple(changed))
        )
        with styled():
            assert (cut in bars.draw(study, sdlp).caption) == told


@pytest.mark.slow
def test_a_rate_that_is_cut_at_zero_is_told(material: StudyMaterial) -> None:
    for missed, told in ((np.arange(21) % 3 == 0, True), (np.ones(21), False)):
        trials = material.trials.assign(
            missed_per_km=missed.astype(float), false_triggers_per_km=1.0
        ).sort_values("condition")
        with styled():
            caption = detection.draw(material._replace(trials=trials)).caption
        assert ("cut at zero" in caption) == told


@pytest.fixture(scope="module")
def means(material: StudyMaterial) -> dict[trajectories.Key, trajectories.Mean]:
    """Mean trajectory of every condition and direction."""
    own = trajectories.own_trajectories(material)
    return {key: trajectories.mean_of(each) for key, each in own.items()}


def test_trajectories_meet_the_line_at_the_crossing(
    means: dict[trajectories.Key, trajectories.Mean],
) -> None:
    assert set(means) == {(name, way) for name in CONDITION_NAMES for way in (-1, 1)}
    for mean in means.values():
        # Linear between two of the 10 Hz places, in which the car curves by 1 cm.
        assert np.interp(0.0, trajectories.TIME, mean.position) == pytest.approx(
            -1.75, abs=0.01
        )


def test_trajectories_count_every_lane_change(
    material: StudyMaterial, means: dict[trajectories.Key, trajectories.Mean]
) -> None:
    assert sum(mean.changes for mean in means.values()) == len(material.lane_changes)


def test_the_band_is_the_interval_of_participants_means(
    means: dict[trajectories.Key, trajectories.Mean],
) -> None:
    mean = means["manual", -1]
    assert mean.participants == 3
    assert np.all(mean.half_width >= 0.0)


def test_a_difference_is_that_of_the_same_participants_from_their_own_manual() -> None:
    flat = np.zeros_like(trajectories.TIME)
    own = {
        ("manual", -1): trajectories.Own({1: flat, 2: flat + 1.0}, {1: 2, 2: 1}),
        ("strong-rapid", -1): trajectories.Own(
            {1: flat + 0.1, 2: flat + 1.3, 3: flat + 9.0}, {1: 2, 2: 2, 3: 2}
        ),
        ("weak-rapid", 1): trajectories.Own({1: flat}, {1: 1}),
    }
    found = trajectories.differences(own)
    assert set(found) == {("strong-rapid", -1)}
    mean = found["strong-rapid", -1]
    assert (mean.participants, mean.changes) == (2, 4)
    np.testing.assert_allclose(mean.position, 0.2)
    # Student's t with one degree of freedom at 0.975 is 12.706; sd of 0.1 and 0.3.
    np.testing.assert_allclose(mean.half_width, 12.706 * 0.1, rtol=1e-4)


def test_differences_are_drawn_below_the_trajectories(
    exhibits: list[Exhibit],
) -> None:
    (exhibit,) = (each for each in exhibits if each.name == "trajectories")
    assert len(panels(exhibit)) == 12
    labels = [axes.get_ylabel() for axes in panels(exhibit) if axes.get_ylabel()]
    assert labels == ["Lateral position [m]", "Minus manual [m]"] * 2


@pytest.mark.slow
def test_without_manual_there_is_no_difference_to_draw(material: StudyMaterial) -> None:
    changes = material.lane_changes.query("condition != 'manual'")
    with styled():
        exhibit = trajectories.draw(material._replace(lane_changes=changes))
    assert len(panels(exhibit)) == 6
    assert "own manual" not in exhibit.caption


def test_strengths_are_told_apart_without_colour() -> None:
    assert len(set(STRENGTH_LINES.values())) == len(STRENGTH_LINES)


def test_text_of_a_figure_stays_text_in_letters_that_every_browser_has(
    exhibits: list[Exhibit],
) -> None:
    (exhibit,) = (each for each in exhibits if each.name == trajectories.NAME)
    assert exhibit.figure is not None
    with styled():
        svg = svg_text(exhibit.figure, exhibit.name, exhibit.title)
    texts = re.findall(r"<text[^>]*>([^<]*)</text>", svg)
    assert "Time from crossing [s]" in texts
    fonts = re.findall(r"(?:font-family: |px )('[^;\"]*)", svg)
    assert fonts
    assert all(font.endswith("', Verdana, Geneva, sans-serif") for font in fonts)


def test_missed_lane_changes_count_in_the_lead_times(
    material: StudyMaterial,
) -> None:
    missed = material.lane_changes.assign(detection_lead_time=0.0)
    with styled():
        exhibit = detection.draw(material._replace(lane_changes=missed))
    for line in panels(exhibit)[0].get_lines()[:3]:
        assert np.all(np.asarray(line.get_ydata()) == 0.0)


def test_an_axis_without_a_bar_has_no_numbers_but_zero(
    material: StudyMaterial,
) -> None:
    trials = material.trials.assign(false_triggers_per_km=0.0, missed_per_km=0.0)
    with styled():
        exhibit = detection.draw(material._replace(trials=trials))
    for axes in panels(exhibit)[1:]:
        assert axes.get_xticks().tolist() == [0.0]
        assert "none" in " ".join(text.get_text() for text in axes.texts)


def test_virtual_drivers_have_no_workload(material: StudyMaterial) -> None:
    (exhibit,) = workload.draw(material)
    assert exhibit.figure is None
    assert "people only" in exhibit.missing


def as_people(material: StudyMaterial) -> StudyMaterial:
    metadata = tuple({**each, "driver_kind": "person"} for each in material.metadata)
    return material._replace(metadata=metadata)


def test_people_without_answers_have_no_workload_either(
    material: StudyMaterial,
) -> None:
    (exhibit,) = workload.draw(as_people(material))
    assert "tlx_raw" in exhibit.missing


def test_without_triggers_detection_is_not_drawn(material: StudyMaterial) -> None:
    trials = material.trials.drop(columns="false_triggers_per_km")
    changes = material.lane_changes.drop(columns="detection_lead_time")
    without = material._replace(trials=trials, lane_changes=changes)
    assert detection.draw(without).missing


@pytest.mark.slow
def test_the_participant_shown_is_the_first_with_most_conditions(
    material: StudyMaterial,
) -> None:
    records = {k: v for k, v in material.records.items() if k != (1, "strong-rapid")}
    with styled():
        exhibit = signals.draw(material._replace(records=records), "strong")
    assert exhibit.caption.startswith("Participant 2,")


def test_the_answer_is_the_paired_difference_in_standard_deviations(
    material: StudyMaterial, exhibits: list[Exhibit]
) -> None:
    (exhibit,) = (each for each in exhibits if each.name == forest.NAME)
    assert exhibit.figure is not None
    rows = list(csv.DictReader(io.StringIO(series.table(exhibit.figure))))
    told = {(row["point"], row["series"]): float(row["x"]) for row in rows}
    # Of three participants: two degrees of freedom, Hedges' factor 1/sqrt(pi).
    own = material.trials.pivot_table("sdlp", "participant", "condition")
    pair = own[["strong-rapid", "manual"]]
    spread = math.sqrt(float(pair.var().mean()))
    difference = float((pair["strong-rapid"] - pair["manual"]).mean())
    expected = difference / spread / math.sqrt(math.pi)
    # The table holds six digits.
    assert told["SDLP", "strong-rapid − manual"] == pytest.approx(expected, rel=1e-5)
    assert len(told) == len(rows) == 7 * 6 + 2 * 2 + 2


def test_two_participants_have_no_standardised_effect(material: StudyMaterial) -> None:
    # Hedges' factor of one degree of freedom is zero: the estimate has no mean.
    pairs = tuple(r._replace(hedges_correction=0.0) for r in material.tests.pairs)
    tests = material.tests._replace(pairs=pairs)
    assert "three participants" in forest.draw(material._replace(tests=tests)).missing


def test_figures_of_one_participant_can_be_those_of_each(
    exhibits: list[Exhibit],
) -> None:
    by_name = {each.name: each for each in exhibits}
    for name in ("signals-strong", "signals-weak", "inconsistency"):
        others = by_name[name].others
        assert [each.name for each in others] == ["1", "2", "3"]
        assert len({each.caption for each in others}) == 3
        assert by_name[name].caption in {each.caption for each in others}


def test_bars_tell_whose_circles_they_have(exhibits: list[Exhibit]) -> None:
    (exhibit,) = (each for each in exhibits if each.name == "sdlp")
    assert exhibit.figure is not None
    points = [
        r["point"] for r in csv.DictReader(io.StringIO(series.table(exhibit.figure)))
    ]
    assert {each for each in points if each} == {f"participant {n}" for n in (1, 2, 3)}


@pytest.mark.slow
def test_a_figure_of_bars_fits_a_column_of_a_journal(material: StudyMaterial) -> None:
    with styled():
        for quantity in QUANTITIES:
            assert published(bars.draw(material, quantity), COLUMN_WIDTH_MM, "pdf")
