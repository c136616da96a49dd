"""What `costeer drivers` prints: a population, its manual driving, δ of its pilots."""

from __future__ import annotations

import json
import math
import os
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import typer

from costeer.cli.console import note, print_table, progress

if TYPE_CHECKING:
    from costeer.drivers.population import Population
    from costeer.validation.manual import ManualDriving, TargetCheck
    from costeer.validation.overview import Quantity


class Asked(NamedTuple):
    """What all tasks are asked.

    Attributes:
        seed: Of the population.
        number: Of drivers.
        jobs: Trials at a time; None for as many as there are processors.
        plot: Where to draw; None for nowhere.
        as_json: Whether to print JSON.
        population: Name of the one that is drawn from.
    """

    seed: int
    number: int
    jobs: int | None
    plot: Path | None
    as_json: bool
    population: str = "virtual"


def show_drawn(asked: Asked, speed: float) -> None:
    """List and draw the parameters that differ between the drivers of a population.

    Args:
        asked: Which population.
        speed: Suggested [m/s].
    """
    from costeer.loop.scenario import TrialSetup, check_setup
    from costeer.validation.drawn import drawn_drivers, trait_pairs
    from costeer.validation.populations import population_named, population_told

    population = population_named(asked.population)
    check_setup(TrialSetup(seed=asked.seed, speed=speed))
    refuse_bad_plot(asked.plot)
    drawn = drawn_drivers(asked.seed, asked.number, speed, population)
    if asked.plot is not None:
        from costeer.validation.drawn_figure import Drawn, population_parameters_svg

        shown = Drawn(asked.seed, drawn, population)
        _write_plot(asked.plot, population_parameters_svg(shown))
    if asked.as_json:
        answer = {
            "seed": asked.seed,
            **_which(population),
            "drivers": drawn,
            "correlations": [pair._asdict() for pair in trait_pairs()],
        }
        _print_json(answer)
        return
    _print_drawn(asked, drawn)
    typer.echo(population_told(population))


def _which(population: Population) -> dict[str, str]:
    """What JSON says of a population."""
    return {
        "population": population.version,
        "name": population.name,
        "domain": population.domain,
    }


def _print_drawn(asked: Asked, drawn: list[dict[str, float]]) -> None:
    from costeer.drivers.traits import FACTORS
    from costeer.pages.units import shown
    from costeer.validation.drawn import spreads

    rows = []
    for s in spreads(drawn):
        unit, factor = shown(s.unit)
        numbers = (f"{value * factor:.4g}" for value in (s.low, s.median, s.high))
        rows.append([s.parameter, unit, *numbers])
    print_table(
        ["parameter", "unit", "5 %", "median", "95 %"],
        rows,
        f"{_virtual(asked.number)}, seed {asked.seed}: what differs between them",
    )
    print_table(
        ["factor", "traits that go together: correlation with the factor"],
        [
            [f.name, ", ".join(f"{n} {r:+.2f}" for n, r in f.loadings.items())]
            for f in FACTORS
        ],
        "two traits of a factor: product of their numbers; all others: independent",
    )


def show_validation(asked: Asked, out: Path | None, data: Path | None) -> None:
    """Let a population drive manually; print the targets, write figure and report.

    Args:
        asked: Which population.
        out: Folder of the report; None for none.
        data: Folder with recordings of people; None for that of COSTEER_DATA.
    """
    from costeer.validation.manual import compare
    from costeer.validation.overview import overview
    from costeer.validation.populations import population_named, population_told

    population_named(asked.population)  # refused before anything is driven
    refuse_bad_plot(asked.plot)
    driving = _driven(asked) if out is None else _reported(asked, out, data)
    if asked.plot is not None:
        from costeer.validation.figure import population_svg

        _write_plot(asked.plot, population_svg(driving))
    comparisons, quantities = compare(driving), overview(driving)
    if asked.as_json:
        _print_json(_driving_as_json(asked.seed, driving, comparisons, quantities))
        return
    _print_targets(asked.seed, asked.number, comparisons)
    domain = driving.population.domain
    typer.echo(f"{population_told(driving.population)}, domain {domain}")
    print_table(
        ["also", "value"],
        [[f"{q.quantity} [{q.unit}]", _short(q.value)] for q in quantities],
    )


def _driven(asked: Asked) -> ManualDriving:
    from costeer.scale.jobs import default_jobs
    from costeer.validation.manual import drive_population
    from costeer.validation.populations import population_named

    with progress("manual trials", asked.number) as advance:
        return drive_population(
            asked.seed,
            asked.number,
            asked.jobs or default_jobs(),
            advance,
            population=population_named(asked.population),
        )


def _reported(asked: Asked, out: Path, data: Path | None) -> ManualDriving:
    """Simulate all that the report stands on, and write it."""
    from costeer.scale.jobs import default_jobs
    from costeer.validation.people.folder import data_folder
    from costeer.validation.populations import population_named
    from costeer.validation.reporting.evidence import Plan, gather
    from costeer.validation.reporting.report import prepare, write_validation

    folder = data_folder(data)
    prepare(out)
    plan = Plan(
        asked.seed,
        asked.number,
        asked.jobs or default_jobs(),
        folder,
        population_named(asked.population),
    )
    evidence = gather(plan, progress)
    note(f"wrote {write_validation(out, evidence)}")
    return evidence.driving


def refuse_bad_plot(plot: Path | None) -> None:
    """Refuse a file that could not be written, before minutes of driving.

    Raises:
        ValueError: If it is no SVG or a folder, or its folder is not writable.
    """
    if plot is None:
        return
    if plot.suffix != ".svg":
        raise ValueError(f"{plot} is no SVG; give --plot a name that ends in .svg")
    folder = next(f for f in (plot.parent, *plot.parent.parents) if f.exists())
    if plot.is_dir() or not folder.is_dir() or not os.access(folder, os.W_OK):
        raise ValueError(f"cannot write {plot}; choose a file that you may write")


def _write_plot(plot: Path, svg: str) -> None:
    from costeer.base.files import write_text

    plot.parent.mkdir(parents=True, exist_ok=True)
    write_text(plot, svg)
    note(f"wrote {plot}")


def _print_targets(seed: int, count: int, comparisons: list[TargetCheck]) -> None:
    from costeer.validation.manual import missed_by

    rows = [
        [
            c.target.name,
            f"{c.target.quantity} [{c.target.unit}]",
            f"{c.target.low:g} to {c.target.high:g}",
            f"{c.value:.3g}",
            "met" if c.met else f"missed by {missed_by(c):.3g}",
        ]
        for c in comparisons
    ]
    print_table(
        ["", "manual driving", "human", "value", ""],
        rows,
        f"{_virtual(count)}, seed {seed}",
    )
    met = sum(c.met for c in comparisons)
    typer.echo(f"{met} of {len(comparisons)} targets met")


def _short(value: float) -> str:
    """Four digits, no power of ten."""
    return f"{value:.0f}" if abs(value) >= 1000.0 else f"{value:.4g}"


def _driving_as_json(
    seed: int,
    driving: ManualDriving,
    comparisons: list[TargetCheck],
    quantities: list[Quantity],
) -> dict[str, object]:
    from costeer.validation.manual import missed_by

    return {
        "seed": seed,
        "participants": len(driving.trials),
        **_which(driving.population),
        "targets": [
            {
                **c.target._asdict(),
                "value": c.value,
                "met": c.met,
                "missed_by": missed_by(c),
            }
            for c in comparisons
        ],
        "also": [q._asdict() for q in quantities],
    }


def show_threshold(asked: Asked) -> None:
    """Compute the inconsistency threshold from pilot drivers who agree."""
    from costeer.controller.consistency import ConsistencyParameters
    from costeer.loop.scenario import PILOT_SEED
    from costeer.scale.jobs import default_jobs
    from costeer.validation.pilot import pilot_setups, pilot_threshold

    count = asked.number
    with progress("pilot trials", len(pilot_setups(count))) as advance:
        result = pilot_threshold(count, asked.jobs or default_jobs(), advance)
    used = ConsistencyParameters().inconsistency_threshold
    if asked.as_json:
        _print_json({"seed": PILOT_SEED, **result._asdict(), "threshold_in_use": used})
        return
    typer.echo(
        f"{count} pilot drivers, seed {PILOT_SEED}, agreeing runs; "
        f"{result.num_samples} samples with opposed torques"
    )
    typer.echo(f"99.9th percentile of the pseudo-works' gap: {result.percentile:.4f} W")
    typer.echo(f"threshold, twice that: {result.threshold:.4f} W; in use: {used:g} W")


def _print_json(answer: dict[str, Any]) -> None:  # Any: JSON values
    def plain(value: Any) -> Any:  # Any: JSON values; JSON has no NaN
        if isinstance(value, dict):
            return {name: plain(item) for name, item in value.items()}
        if isinstance(value, list):
            return [plain(item) for item in value]
        missing = isinstance(value, float) and not math.isfinite(value)
        return None if missing else value

    typer.echo(json.dumps(plain(answer), indent=2, ensure_ascii=False))


def _virtual(count: int) -> str:
    """How many virtual drivers, in words."""
    return "1 virtual driver" if count == 1 else f"{count} virtual drivers"
