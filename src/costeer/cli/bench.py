"""`costeer bench`: how fast it is here, and beside two peers."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from costeer.cli.console import note, print_table
from costeer.cli.validate import in_range

if TYPE_CHECKING:
    from collections.abc import Callable

    from benchmarks.speed.timing import Effort, Figure, Outcome, Skipped


_VERDICT = "verdict, "

CHECKOUT = Path(__file__).parents[3]
"""Where `benchmarks` lies beside `src`, unless costeer was installed without it."""


def bench(
    quick: Annotated[
        bool, typer.Option("--quick", help="Run fewer rounds and shorter trials.")
    ] = False,
    drive: Annotated[
        bool,
        typer.Option("--drive", help="Measure how well a drive keeps time instead."),
    ] = False,
    seconds: Annotated[
        float,
        typer.Option(callback=in_range(5, 36_000), help="With --drive: duration [s]."),
    ] = 60.0,
    browser: Annotated[
        str,
        typer.Option(
            help="With --drive: Chromium binary that draws the page meanwhile."
        ),
    ] = "",
    json: Annotated[
        bool, typer.Option("--json", help="Print the results as JSON.")
    ] = False,
) -> None:
    """Measure the speed of the control step, a trial, a batch or a drive.

    Each number is the median of several rounds, with the lowest and the highest. Runs
    in a clone of the repository; peers come with the extra `bench`, or with `make
    bench`.

    Example:
        costeer bench
        costeer bench --quick --json
        costeer bench --drive --seconds 600 --browser /usr/bin/chromium
    """
    _find_benchmarks()
    if drive:
        _bench_drive(seconds, browser, json)
        return
    from benchmarks.speed.machine import machine
    from benchmarks.speed.timing import FULL, QUICK, Figure

    about = machine()
    outcome = _measure(QUICK if quick else FULL)
    figures = [found for found in outcome if isinstance(found, Figure)]
    skipped = [found for found in outcome if not isinstance(found, Figure)]
    if json:
        _print_json(about, figures, skipped)
    else:
        _print_text(about, figures, skipped)


def _find_benchmarks() -> None:
    """Let the folder `benchmarks` of the checkout be imported.

    Raises:
        ValueError: If there is none: it is no part of what pip installs.
    """
    if not (CHECKOUT / "benchmarks" / "speed").is_dir():
        raise ValueError(
            f"there is no folder benchmarks in {CHECKOUT}: what is measured comes with "
            "the sources, not with the installed package; clone the repository and run "
            "'make bench' there"
        )
    if str(CHECKOUT) not in sys.path:
        sys.path.insert(0, str(CHECKOUT))


def _bench_drive(seconds: float, browser: str, as_json: bool) -> None:
    """Drive for so long, print what kept its time and what did not."""
    from benchmarks.speed.machine import machine
    from benchmarks.speed.pace import figures, measure_drive

    about = machine()
    note(f"driving for {seconds:g} s")
    material = measure_drive(seconds, browser)
    about["priority"] = material.priority
    found = figures(material)
    if as_json:
        import json

        answer = {"machine": about, "figures": [each._asdict() for each in found]}
        typer.echo(json.dumps(answer, indent=2, ensure_ascii=False))
        return
    for name, value in about.items():
        typer.echo(f"{name:10} {value}")
    rows = [[each.name, _short(each.value), each.unit, each.verdict] for each in found]
    print_table(["measured", "value", "unit", "budget"], rows)


def _measure(effort: Effort) -> Outcome:
    """Everything, group by group."""
    from benchmarks.speed.control import measure_control_step, measure_network
    from benchmarks.speed.peers import measure_peers
    from benchmarks.speed.start import measure_start
    from benchmarks.speed.trials import measure_engines, measure_trials

    groups: dict[str, Callable[[Effort], Outcome]] = {
        "control step": measure_control_step,
        "network": measure_network,
        "trials": measure_trials,
        "engines": measure_engines,
        "plants": measure_peers,
        "start": measure_start,
    }
    outcome: Outcome = []
    for name, measure in groups.items():
        note(f"measuring: {name}")
        outcome += measure(effort)
    return outcome


def _print_text(
    about: dict[str, str | int], figures: list[Figure], skipped: list[Skipped]
) -> None:
    for name, value in about.items():
        typer.echo(f"{name:10} {value}")
    print_figures(figures)
    for missing in skipped:
        typer.echo(f"skipped: {missing.name}: {missing.reason}")
    typer.echo(
        "Most of a ratio to a peer is compilation, not a better method: compare the "
        "peer with costeer's car in plain Python."
    )


def print_figures(figures: list[Figure]) -> None:
    """A row for each figure; verdicts of the network in a table of their own."""
    rows = [
        [
            found.name,
            found.unit,
            *(_short(value) for value in (found.median, found.low, found.high)),
            found.remark,
        ]
        for found in figures
        if not _is_verdict(found)
    ]
    print_table(["measured", "unit", "median", "lowest", "highest", "remark"], rows)
    _print_verdicts([found for found in figures if _is_verdict(found)])


def _is_verdict(found: Figure) -> bool:
    """Whether a figure belongs to the table of verdicts by hidden size."""
    return found.group.startswith(_VERDICT)


def _print_verdicts(figures: list[Figure]) -> None:
    """One row for each network, medians only, then what became of the budgets."""
    if not figures:
        return
    names = list(dict.fromkeys(f"{found.name} [{found.unit}]" for found in figures))
    rows: dict[str, list[str]] = {}
    for found in figures:
        name = found.group.removeprefix(_VERDICT)
        rows.setdefault(name, [name]).append(_short(found.median))
    print_table(["exact window", *names], list(rows.values()))
    for found in figures:
        if found.remark:
            typer.echo(f"{found.group}, {found.name}: {found.remark}")


def _short(value: float) -> str:
    """Three digits, no power of ten."""
    return f"{value:.0f}" if abs(value) >= 100.0 else f"{value:.3g}"


def _print_json(
    about: dict[str, str | int], figures: list[Figure], skipped: list[Skipped]
) -> None:
    import json

    answer = {
        "machine": about,
        "figures": [found._asdict() for found in figures],
        "skipped": [missing._asdict() for missing in skipped],
    }
    typer.echo(json.dumps(answer, indent=2, ensure_ascii=False))
