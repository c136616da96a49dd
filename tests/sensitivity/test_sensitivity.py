"""Sobol indices agree with closed forms; an analysis goes on where it stopped."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import numpy as np
import pytest

from costeer.loop.scenario import PILOT_SEED, loop_parameters
from costeer.scale.cluster import workers
from costeer.scale.shard import Shard
from costeer.sensitivity.factors import AIMS, FACTORS
from costeer.sensitivity.figures import bins, separate
from costeer.sensitivity.merge import merge_sensitivity
from costeer.sensitivity.report import _what_counts, idle, write_report
from costeer.sensitivity.run import (
    Index,
    Outcome,
    Point,
    Settings,
    check_settings,
    drive_all,
    indices_of,
    points,
    setup_of,
)
from tests.study.fakes import contents

pytest.importorskip("SALib")

SMALL = Settings(base=8, drivers=1, length=1500.0)


def ignore(_: int) -> None:
    """Show no progress."""


def unit(point: Point) -> list[float]:
    """Factors from 0 to 1 within their bounds."""
    pairs = zip(point, FACTORS, strict=True)
    return [(x - each.low) / (each.high - each.low) for x, each in pairs]


def test_a_sum_has_the_indices_of_its_weights() -> None:
    # Var of w·u is w²/12, so the shares of 1, 2 and 3 are 1/14, 4/14 and 9/14, alone
    # as in total. The scrambled sequence of 1024 is within a hundredth of them.
    settings = Settings(base=1024)
    values = np.array([u[0] + 2 * u[1] + 3 * u[2] for u in map(unit, points(settings))])
    found = indices_of(settings, "made up", values)
    assert not isinstance(found, str)
    wanted = [1 / 14, 4 / 14, 9 / 14, *[0.0] * (len(FACTORS) - 3)]
    assert [row.first_order for row in found] == pytest.approx(wanted, abs=0.02)
    assert [row.total for row in found] == pytest.approx(wanted, abs=0.02)
    for row, share in zip(found, wanted, strict=True):
        assert abs(row.total - share) <= 2.0 * row.total_half_width + 1e-12


@pytest.mark.slow
def test_factors_that_only_act_together_have_a_total_alone() -> None:
    # Of (u-1/2)(v-1/2) no part is by u or v alone. The estimate of a total is a mean
    # of 1024 squares whose standard deviation is 1.8 of it: three standard errors are
    # 0.17.
    settings = Settings(base=1024)
    values = np.array(
        [(u[3] - 0.5) * (u[4] - 0.5) for u in map(unit, points(settings))]
    )
    found = indices_of(settings, "made up", values)
    assert not isinstance(found, str)
    assert [row.first_order for row in found[3:5]] == pytest.approx([0, 0], abs=0.05)
    assert [row.total for row in found[3:5]] == pytest.approx([1, 1], abs=0.17)


def test_a_measure_that_does_not_vary_or_is_missing_says_so() -> None:
    same = indices_of(SMALL, "m", np.full(88, 2.0))
    assert same == "all samples have the same value"
    some = np.arange(88.0)
    some[3] = np.nan
    assert indices_of(SMALL, "m", some) == "1 of 88 samples have no value"


def test_usual_values_are_those_of_the_guidance_and_within_the_bounds() -> None:
    usual = tuple(each.usual for each in FACTORS)
    setup = setup_of(SMALL, usual, 1)
    given = loop_parameters(setup).controller
    plain = loop_parameters(
        setup._replace(parameters=(), condition="strong-normal")
    ).controller
    assert given == plain
    assert all(each.low <= each.usual <= each.high for each in FACTORS)
    assert setup.seed == PILOT_SEED


def test_only_whole_numbers_of_samples_are_driven() -> None:
    place = [each.whole for each in FACTORS].index(True)
    assert all(point[place] == int(point[place]) for point in points(SMALL))


def made_up(point: Point) -> Outcome:
    """Every measure is a sum of the factors; one is never there."""
    total = sum(unit(point))
    return {aim.name: total for aim in AIMS} | {"swrr": float("nan")}


def test_an_analysis_goes_on_where_it_stopped(tmp_path: Path) -> None:
    asked: list[Point] = []

    def stopping(point: Point) -> Outcome:
        asked.append(point)
        if len(asked) == 30:
            raise KeyboardInterrupt
        return made_up(point)

    with pytest.raises(KeyboardInterrupt):
        drive_all(tmp_path, SMALL, 1, ignore, stopping)
    kept = len(list((tmp_path / "results").iterdir()))
    assert 29 <= kept <= 87  # others ran until the stop was seen
    asked.clear()

    def counted(point: Point) -> Outcome:
        asked.append(point)
        return made_up(point)

    outcomes = drive_all(tmp_path, SMALL, 1, ignore, counted)
    assert len(asked) == 88 - kept
    assert [each["sdlp"] for each in outcomes] == [
        made_up(point)["sdlp"] for point in points(SMALL)
    ]
    with pytest.raises(ValueError, match="holds an analysis with other settings"):
        drive_all(tmp_path, SMALL._replace(seed=2), 1, ignore, made_up)


@pytest.mark.slow
@pytest.mark.usefixtures("undrawn")
def test_a_report_has_every_measure_and_says_what_is_missing(tmp_path: Path) -> None:
    outcomes = drive_all(tmp_path, SMALL, 1, ignore, made_up)
    page = write_report(tmp_path, SMALL, outcomes).read_text("utf-8")
    assert "no index: 88 of 88 samples have no value" in page
    with (tmp_path / "indices.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == len(FACTORS) * (len(AIMS) - 1)
    drawn = {file.stem for file in (tmp_path / "figures").glob("*.svg")}
    assert {"indices", "curves-sdlp"} <= drawn
    assert "curves-swrr" not in drawn


def test_repeats_of_a_draw_are_no_draws_of_their_own() -> None:
    place, width = 3, len(FACTORS) + 2
    drawn = points(SMALL)
    x = np.array([point[place] for point in drawn])
    alone, means = separate(place, x, np.arange(float(len(drawn))))
    # Of each eleven samples nine have the first point's value, the fifth and the last
    # that of the second.
    assert len(alone) == 2 * SMALL.base
    assert set(alone) == set(x)
    assert means[0] == pytest.approx((sum(range(11)) - 4 - 10) / 9.0)
    assert means[SMALL.base] == pytest.approx((4 + 10) / 2.0)
    assert means[1] == means[0] + width


def test_a_draw_without_a_value_is_missing_and_others_are_means_of_the_rest() -> None:
    width = len(FACTORS) + 2
    values = np.arange(2.0 * width)
    values[[1, width - 1, width]] = np.nan
    _, means = separate(0, np.zeros(2 * width), values)
    # The second draw of the first eleven has the second and the last sample alone.
    assert np.isnan(means[2])
    assert means[1] == pytest.approx(np.mean(np.arange(width + 2, 2 * width - 1)))


def test_bins_hold_the_means_of_what_is_in_them() -> None:
    place = [each.name for each in FACTORS].index("γ")
    drawn = points(SMALL)
    gamma = np.array([point[place] for point in drawn])
    factor = FACTORS[place]
    eighth = (factor.high - factor.low) / 8.0
    in_first = gamma < factor.low + eighth
    found = bins(place, drawn, np.where(in_first, 5.0, np.arange(len(drawn)) % 2))
    assert found.middle[0] == pytest.approx(factor.low + eighth / 2.0)
    # A Sobol sequence of 8 puts one point of each of its two sets into each eighth.
    assert found.mean[0] == found.tenth[0] == found.ninetieth[0] == 5.0
    assert found.half[0] == 0.0
    assert (found.tenth[1:] >= 0.0).all()
    assert (found.ninetieth[1:] <= 1.0).all()
    number = np.arange(len(drawn))
    found = bins(place, drawn, np.where(gamma == gamma[0], 1.0, 3.0))
    at = int((gamma[0] - factor.low) / eighth)
    # Draws of 1 and 3: standard deviation the root of 2, of their mean 1.
    assert found.mean[at] == pytest.approx(2.0)
    assert found.half[at] == pytest.approx(1.96)
    assert number.size == 88


def row(factor: str, total: float, half: float) -> Index:
    return Index("made up", factor, 0.0, 0.0, total, half)


def whole_rows(**totals: tuple[float, float]) -> list[Index]:
    """Every factor with a total index and half its interval; 0.01 if not given."""
    return [row(f.name, *totals.get(f.name, (0.01, 0.01))) for f in FACTORS]


def test_the_page_names_only_factors_that_can_be_told_from_none() -> None:
    said = _what_counts(whole_rows(δ=(0.3, 0.1), γ=(0.4, 0.41), λ=(0.2, 0.1)))
    assert said == "δ 0.30 ± 0.10, then λ 0.20 ± 0.10 (total index)."
    alone = _what_counts(whole_rows(δ=(0.3, 0.1)))
    assert alone == "δ 0.30 ± 0.10 (total index)."
    none = _what_counts(whole_rows(γ=(0.4, 0.41)))
    assert none == "no factor can be told from none."


def test_the_page_does_not_name_a_winner_that_the_samples_do_not_decide() -> None:
    said = _what_counts(whole_rows(δ=(1.45, 1.84), γ=(0.9, 0.1)))
    assert said.startswith("not decided by these samples: δ 1.45 ± 1.84")


def test_a_factor_matters_for_none_if_its_interval_is_small_for_all_that_decide() -> (
    None
):
    found: dict[str, list[Index] | str] = {
        "one": whole_rows(δ=(0.3, 0.1), λ=(0.02, 0.02)),
        "two": whole_rows(γ=(0.04, 0.02), λ=(0.02, 0.04)),
        "undecided": whole_rows(strength=(0.9, 0.9)),
        "missing": "all samples have the same value",
    }
    rest = [f.name for f in FACTORS if f.name not in {"δ", "γ", "λ"}]
    assert idle(found) == rest
    assert idle({"undecided": whole_rows(strength=(0.9, 0.9))}) == []


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"base": 100}, "samples is 100; give a power of two"),
        ({"base": 1}, "samples is 1;"),
        ({"drivers": 0}, "drivers is 0; give 1 to"),
        ({"length": 100.0}, "length is 100; give 1500 to"),
    ],
)
def test_settings_out_of_range_are_refused(
    changes: dict[str, int], message: str
) -> None:
    with pytest.raises(ValueError, match=message):
        check_settings(SMALL._replace(**changes))


def sum_of_factors(point: Point) -> Outcome:
    """An outcome that follows from the sample alone."""
    return {aim.name: sum(unit(point)) + n for n, aim in enumerate(AIMS)}


def run_shard(out: Path, number: int, total: int) -> list[Outcome]:
    with workers(1) as pool:
        return drive_all(out, SMALL, pool, ignore, sum_of_factors, Shard(number, total))


@pytest.mark.parametrize("shared", [True, False])
def test_shards_are_the_whole_analysis(tmp_path: Path, shared: bool) -> None:
    whole = run_shard(tmp_path / "whole", 1, 1)
    names = ["all", "all", "all"] if shared else ["1", "2", "3"]
    sizes = [
        len(run_shard(tmp_path / name, number, 3))
        for number, name in enumerate(names, 1)
    ]
    # 8 · (9 + 2) samples.
    assert sum(sizes) == len(whole) == 88
    folders = [tmp_path / name for name in dict.fromkeys(names)]
    done = merge_sensitivity(folders, tmp_path / "all")
    assert (done.outcomes, done.settings, done.repeated) == (whole, SMALL, ())
    assert contents(tmp_path / "all") == contents(tmp_path / "whole")


def test_samples_that_are_missing_or_differ_are_named(tmp_path: Path) -> None:
    run_shard(tmp_path / "1", 1, 2)
    with pytest.raises(ValueError, match="44 of 88 samples are missing: sample 2, "):
        merge_sensitivity([tmp_path / "1"])
    run_shard(tmp_path / "whole", 1, 1)
    file = tmp_path / "1" / "results" / "000000.json"
    told = json.loads(file.read_text())
    told["values"][AIMS[0].name] += 1.0
    file.write_text(json.dumps(told))
    with pytest.raises(ValueError, match="sample 1 has different results in"):
        merge_sensitivity([tmp_path / "1", tmp_path / "whole"], tmp_path / "all")
    assert not (tmp_path / "all").exists()


def test_a_folder_that_is_no_analysis_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="is no sensitivity analysis"):
        merge_sensitivity([tmp_path])
    run_shard(tmp_path / "1", 1, 2)
    with pytest.raises(ValueError, match="2 folders need one to be put together in"):
        merge_sensitivity([tmp_path / "1", tmp_path / "1"])
