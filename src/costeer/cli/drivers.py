"""`costeer drivers`: draw, plot, validate and fit virtual drivers; set δ."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, NamedTuple

import typer

from costeer.cli.reading import AS_FOUND, OPTIONS, Told, options_given, reads_tables
from costeer.cli.units import parse_speed
from costeer.cli.validate import at_least, in_range

DRIVERS, PILOTS = 200, 30
"""How many drivers are asked for if not said: of a population, and as pilots."""

_POPULATION = "virtual"
SPEED = 70 / 3.6
"""Suggested speed if not said [m/s]."""


class _Task(NamedTuple):
    """One of the things that the command does.

    Attributes:
        words: What it does, as the middle of a sentence.
        options: Those that it takes.
    """

    words: str
    options: frozenset[str]


_LIST = ""
_UNNAMED = "costeer drivers without --validate, --threshold or --fit"
_TASKS = {
    "--fit": _Task(
        "fits a driver to a recording",
        frozenset({"--car", "--plot", "--out", "--jobs", "--json", *OPTIONS}),
    ),
    "--threshold": _Task(
        "drives the pilot drivers, who have a seed of their own",
        frozenset({"--participants", "--jobs", "--json"}),
    ),
    "--validate": _Task(
        "holds a population at 70 km/h against people",
        frozenset(
            {
                "--out",
                "--data",
                "--plot",
                "--participants",
                "--seed",
                "--jobs",
                "--json",
                "--population",
            }
        ),
    ),
    _LIST: _Task(
        "lists and plots a population",
        frozenset(
            {
                "--plot",
                "--participants",
                "--seed",
                "--speed",
                "--json",
                "--population",
            }
        ),
    ),
}


@reads_tables
def drivers(
    validate: Annotated[
        bool,
        typer.Option(
            "--validate",
            help="Let the population drive manually and print measures M1 to M12.",
        ),
    ] = False,
    out: Annotated[
        Path | None,
        typer.Option(
            help="With --validate: folder of the report to write; with "
            "--fit: FILE.yaml for the fitted driver."
        ),
    ] = None,
    data: Annotated[
        Path | None,
        typer.Option(
            help="With --out: folder with recordings of people; by default "
            "the one that the environment variable COSTEER_DATA names."
        ),
    ] = None,
    fit: Annotated[
        Path | None, typer.Option(help="Recording to fit a driver to.")
    ] = None,
    car: Annotated[
        str | None,
        typer.Option(help="With --fit: car that was driven, a name or FILE.yaml."),
    ] = None,
    threshold: Annotated[
        bool,
        typer.Option(
            "--threshold",
            help="Compute the inconsistency threshold δ from pilot drivers.",
        ),
    ] = False,
    plot: Annotated[
        Path | None,
        typer.Option(
            help="FILE.svg for a figure of the population, its driving or a fit."
        ),
    ] = None,
    population: Annotated[
        str | None,
        typer.Option(
            metavar="NAME",
            help="Population to draw drivers from: virtual (the default), "
            "virtual-traffic or virtual-2.",
        ),
    ] = None,
    participants: Annotated[
        int | None,
        typer.Option(
            callback=in_range(1, 100_000),
            help="Number of drivers; by default 200, with --threshold 30.",
        ),
    ] = None,
    seed: Annotated[
        int | None,
        typer.Option(
            callback=at_least(0), help="Seed of the population; by default 1."
        ),
    ] = None,
    speed: Annotated[
        float | None,
        typer.Option(
            parser=parse_speed,
            metavar="SPEED",
            help="Suggested speed for the list of drivers [m/s], or with a "
            "unit; by default 70km/h.",
        ),
    ] = None,
    jobs: Annotated[
        int | None,
        typer.Option(
            callback=in_range(1, 256),
            help="Number of trials run in parallel; by default one per processor.",
        ),
    ] = None,
    json: Annotated[
        bool, typer.Option("--json", help="Print the results as JSON.")
    ] = False,
    told: Told = AS_FOUND,
) -> None:
    """Draw, plot, validate and fit virtual drivers.

    Without options the command lists what differs between the drivers of a population,
    and --plot draws it. With --validate the population drives manually: --plot draws
    how it drives, and --out writes a full report that compares it with people. The
    drivers are calibrated on manual driving only; how they respond to guidance is a
    prediction.

    Example:
        costeer drivers --participants 12 --seed 1 --plot out/population.svg
        costeer drivers --validate --out out/validation
        costeer drivers --validate --population virtual-traffic
        costeer drivers --fit out/study/records/01-manual.parquet
        costeer drivers --threshold
    """
    task = _chosen(
        {"--fit": fit is not None, "--threshold": threshold, "--validate": validate}
    )
    given = {
        "--out": out,
        "--data": data,
        "--car": car,
        "--plot": plot,
        "--population": population,
        "--participants": participants,
        "--seed": seed,
        "--speed": speed,
        "--jobs": jobs,
    }
    named = [name for name, value in given.items() if value is not None]
    _refuse_useless(task, [*named, *options_given(told)])
    if data is not None and out is None:
        raise ValueError("--data is for the report; add --out DIR, or leave it out")
    if fit is not None:
        from costeer.cli.driver_fit import show_fit

        show_fit(fit, json, jobs, plot, out, car, told)
        return
    from costeer.cli import driver_tables as tables

    number = participants or (PILOTS if threshold else DRIVERS)
    asked = tables.Asked(
        seed=1 if seed is None else seed,
        number=number,
        jobs=jobs,
        plot=plot,
        as_json=json,
        population=population or _POPULATION,
    )
    if threshold:
        tables.show_threshold(asked)
    elif validate:
        tables.show_validation(asked, out, data)
    else:
        tables.show_drawn(asked, SPEED if speed is None else speed)


def _chosen(flags: dict[str, bool]) -> str:
    """The flag that says what to do; empty if none is given.

    Raises:
        ValueError: If there are several.
    """
    names = [name for name, given in flags.items() if given]
    if len(names) > 1:
        raise ValueError(f"{' and '.join(names)} are different tasks; give one of them")
    return names[0] if names else _LIST


def _refuse_useless(task: str, given: list[str]) -> None:
    """Refuse options that would do nothing.

    Raises:
        ValueError: If there are any.
    """
    useless = [name for name in given if name not in _TASKS[task].options]
    if useless:
        raise ValueError(
            f"{task or _UNNAMED} {_TASKS[task].words}; leave "
            f"{' and '.join(useless)} out{_takers(task, useless)}"
        )


def _takers(task: str, useless: list[str]) -> str:
    """What to add instead, where no task was named and one takes the options."""
    takers = [
        name for name, each in _TASKS.items() if name and each.options >= set(useless)
    ]
    return f", or add {' or '.join(takers)}" if task == _LIST and takers else ""
