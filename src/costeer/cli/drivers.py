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
        bool, typer.Option("--validate", help="Drive manually; M1 to M12.")
    ] = False,
    out: Annotated[
        Path | None,
        typer.Option(
            help="With --validate: folder of the report; with --fit: FILE.yaml of the "
            "driver."
        ),
    ] = None,
    data: Annotated[
        Path | None,
        typer.Option(help="With --out: recordings of people; COSTEER_DATA."),
    ] = None,
    fit: Annotated[
        Path | None, typer.Option(help="Fit a driver to the recording FILE.")
    ] = None,
    car: Annotated[
        str | None,
        typer.Option(help="With --fit: that was driven, a name or FILE.yaml."),
    ] = None,
    threshold: Annotated[
        bool, typer.Option("--threshold", help="Compute δ from pilot drivers.")
    ] = False,
    plot: Annotated[
        Path | None,
        typer.Option(help="Draw into FILE.svg: the population, its driving, or a fit."),
    ] = None,
    population: Annotated[
        str | None,
        typer.Option(
            metavar="NAME",
            help="Drawn from: virtual, virtual-traffic, virtual-2; virtual.",
        ),
    ] = None,
    participants: Annotated[
        int | None,
        typer.Option(callback=in_range(1, 100_000), help="Drivers; 200, as pilots 30."),
    ] = None,
    seed: Annotated[
        int | None, typer.Option(callback=at_least(0), help="Of the population; 1.")
    ] = None,
    speed: Annotated[
        float | None,
        typer.Option(
            parser=parse_speed,
            metavar="SPEED",
            help="Suggested, for the list [m/s], or with its unit; 70km/h.",
        ),
    ] = None,
    jobs: Annotated[
        int | None,
        typer.Option(
            callback=in_range(1, 256), help="Trials at a time; as many as processors."
        ),
    ] = None,
    json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
    told: Told = AS_FOUND,
) -> None:
    """Draw, plot, validate and fit virtual drivers.

    Without flags it lists what is drawn for a population, and --plot draws that.
    With --validate the population drives manually, --plot draws how, and --out
    writes the whole report beside people. Calibration looks at manual driving only;
    what guidance does to these drivers is a prediction.

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
