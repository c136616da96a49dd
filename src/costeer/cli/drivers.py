"""`costeer drivers`: draw, validate and plot virtual drivers; set the threshold."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from costeer.cli.console import note, print_table, progress
from costeer.cli.units import parse_speed
from costeer.cli.validate import at_least, in_range

if TYPE_CHECKING:
    from costeer.validation.manual import Comparison, ManualDriving
    from costeer.validation.overview import Quantity

DRIVERS, PILOTS = 200, 30
"""How many drivers are asked for if not said: of a population, and as pilots."""


def drivers(
    validate: Annotated[
        bool, typer.Option("--validate", help="Drive manually; M1 to M12.")
    ] = False,
    threshold: Annotated[
        bool, typer.Option("--threshold", help="Compute δ from pilot drivers.")
    ] = False,
    plot: Annotated[
        Path | None, typer.Option(help="Draw manual driving into FILE.svg.")
    ] = None,
    participants: Annotated[
        int | None,
        typer.Option(callback=in_range(1, 100_000), help="Drivers; 200, as pilots 30."),
    ] = None,
    seed: Annotated[
        int | None, typer.Option(callback=at_least(0), help="Of the population; 1.")
    ] = None,
    speed: Annotated[
        float,
        typer.Option(
            parser=parse_speed,
            metavar="SPEED",
            help="Suggested, for the list [m/s], or with its unit: 70km/h.",
        ),
    ] = 70 / 3.6,
    jobs: Annotated[
        int | None,
        typer.Option(
            callback=in_range(1, 256), help="Trials at a time; as many as processors."
        ),
    ] = None,
    json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
) -> None:
    """Draw, plot and validate virtual drivers.

    Without flags it lists what is drawn for a population. Calibration looks at manual
    driving only; what guidance does to these drivers is a prediction.

    Example:
        costeer drivers --validate --plot out/drivers.svg
        costeer drivers --participants 12 --seed 1 --json
        costeer drivers --threshold
    """
    if threshold:
        if validate or plot is not None or seed is not None:
            raise ValueError(
                "--threshold drives the pilot drivers, who have a seed of their own; "
                "leave --validate, --plot and --seed out"
            )
        _show_threshold(participants or PILOTS, jobs, json)
    elif validate or plot is not None:
        count = DRIVERS if participants is None else participants
        _show_driving(1 if seed is None else seed, count, jobs, plot, json)
    else:
        count = DRIVERS if participants is None else participants
        _show_drawn(1 if seed is None else seed, count, speed, json)


def _show_drawn(seed: int, count: int, speed: float, as_json: bool) -> None:
    """List the parameters that differ between the drivers of a population."""
    from costeer.loop.scenario import TrialSetup, check_setup
    from costeer.validation.drawn import drawn_drivers, spreads

    check_setup(TrialSetup(seed=seed, speed=speed))
    drawn = drawn_drivers(seed, count, speed)
    if as_json:
        _print_json({"seed": seed, "drivers": drawn})
        return
    rows = [
        [s.parameter, s.unit, *(f"{value:.4g}" for value in (s.low, s.median, s.high))]
        for s in spreads(drawn)
    ]
    print_table(
        ["parameter", "unit", "5 %", "median", "95 %"],
        rows,
        f"{_virtual(count)}, seed {seed}: what differs between them",
    )


def _show_driving(
    seed: int, count: int, jobs: int | None, plot: Path | None, as_json: bool
) -> None:
    """Let a population drive manually; print the targets, write the figure."""
    from costeer.study.folder import write_text
    from costeer.study.jobs import default_jobs
    from costeer.validation.manual import compare, drive_population
    from costeer.validation.overview import overview

    _refuse_bad_plot(plot)
    with progress("manual trials", count) as advance:
        driving = drive_population(seed, count, jobs or default_jobs(), advance)
    if plot is not None:
        from costeer.validation.figure import population_svg

        plot.parent.mkdir(parents=True, exist_ok=True)
        write_text(plot, population_svg(driving))
        note(f"wrote {plot}")
    comparisons, quantities = compare(driving), overview(driving)
    if as_json:
        _print_json(_driving_as_json(seed, driving, comparisons, quantities))
        return
    _print_targets(seed, count, comparisons)
    print_table(
        ["also", "value"],
        [[f"{q.quantity} [{q.unit}]", _short(q.value)] for q in quantities],
    )


def _refuse_bad_plot(plot: Path | None) -> None:
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


def _print_targets(seed: int, count: int, comparisons: list[Comparison]) -> None:
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
    comparisons: list[Comparison],
    quantities: list[Quantity],
) -> dict[str, object]:
    from costeer.drivers.population import POPULATION_VERSION
    from costeer.validation.manual import missed_by

    return {
        "seed": seed,
        "participants": len(driving.trials),
        "population": POPULATION_VERSION,
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


def _show_threshold(count: int, jobs: int | None, as_json: bool) -> None:
    """Compute the inconsistency threshold from pilot drivers who agree."""
    from costeer.controller.consistency import ConsistencyParameters
    from costeer.loop.scenario import PILOT_SEED
    from costeer.study.jobs import default_jobs
    from costeer.validation.pilot import pilot_setups, pilot_threshold

    with progress("pilot trials", len(pilot_setups(count))) as advance:
        result = pilot_threshold(count, jobs or default_jobs(), advance)
    used = ConsistencyParameters().inconsistency_threshold
    if as_json:
        _print_json({"seed": PILOT_SEED, **result._asdict(), "threshold_in_use": used})
        return
    typer.echo(
        f"{count} pilot drivers, seed {PILOT_SEED}, agreeing runs; "
        f"{result.num_samples} samples with opposed torques"
    )
    typer.echo(f"99.9th percentile of the pseudo-works' gap: {result.percentile:.4f} W")
    typer.echo(f"threshold, twice that: {result.threshold:.4f} W; in use: {used:g} W")


def _print_json(answer: dict[str, Any]) -> None:  # Any: JSON values
    import json
    import math

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
