"""`costeer drivers --fit FILE`: a driver fitted to a recording of manual driving."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from costeer.cli.console import note, print_table, progress
from costeer.cli.driver_tables import refuse_bad_plot
from costeer.cli.reading import AS_FOUND, Told, way_of

if TYPE_CHECKING:
    from costeer.identification.fit import DriverFit
    from costeer.identification.parameters import Estimate
    from costeer.records.columns import TrialRecord
    from costeer.validation.fitted import Check


def show_fit(
    path: Path,
    as_json: bool,
    jobs: int | None,
    plot: Path | None,
    out: Path | None,
    car: str | None = None,
    told: Told = AS_FOUND,
) -> None:
    """Fit a driver, check the fit by simulation, print and draw both.

    Args:
        path: Trial record, CSV or Parquet.
        as_json: Print JSON instead of tables.
        jobs: Trials at a time; as many as processors if None.
        plot: Draw the estimates into this SVG, if given.
        out: Write the driver into this YAML file, if given.
        car: That was driven, a name or a file; None takes the record's.
        told: How a table is to be read.

    Raises:
        ValueError: If the recording cannot be fitted.
        OSError: If a file cannot be read or written.
    """
    from costeer.identification.fit import fit_driver
    from costeer.identification.recording import doubts_of
    from costeer.scale.jobs import default_jobs
    from costeer.validation.fitted import REPEATS, check_fit

    refuse_bad_plot(plot)
    if out is not None and out.suffix not in (".yaml", ".yml"):
        raise ValueError(f"--out is {str(out)!r}; a driver is a file: give NAME.yaml")
    record, notes = _recording(path, told)
    try:
        fit = fit_driver(record, car)
    except ValueError as error:
        doubts = [*notes, *doubts_of(record)]
        raise ValueError("; ".join([f"{path}: {error}", *doubts])) from error
    fit = fit._replace(notes=(*notes, *fit.notes))
    try:
        with progress("check by simulation", REPEATS) as advance:
            checks = check_fit(
                record, fit, jobs or default_jobs(), advance=advance, car=car
            )
    except ValueError as error:
        note(f"not checked: {error}")
        checks = []
    if plot is not None:
        _draw(plot, fit, record)
    if out is not None:
        _write(out, fit, path)
    if as_json:
        _print_json(path, fit, checks)
    else:
        _print_tables(path, fit, checks)


def _recording(path: Path, told: Told) -> tuple[TrialRecord, list[str]]:
    """The recording under costeer's names, and what was assumed of it."""
    from costeer.records.adaptation import adapted, cleaned
    from costeer.records.contradictions import lanes_of
    from costeer.records.record import read_noted

    way = way_of(told)
    record, notes = read_noted(path, way.reading)
    try:
        columns, renamed = adapted(record.columns, way.adaptation)
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from error
    if "time" in columns:
        lanes = lanes_of(record.metadata)
        columns, dropped = cleaned(columns, way.adaptation, lanes)
        renamed += dropped
    return record._replace(columns=columns), [*notes, *renamed]


def _write(out: Path, fit: DriverFit, path: Path) -> None:
    """Write the driver for `--driver`, with what the fit was made of."""
    from costeer.drivers.population import SECOND
    from costeer.loop.inputs import write_driver

    out.parent.mkdir(parents=True, exist_ok=True)
    about = {
        "fitted_to": path.name,
        "population": SECOND.version,
        "lane_keeping": fit.lane_keeping,
        "estimated": [each.name for each in fit.estimates],
    }
    write_driver(out, fit.driver, about)
    note(f"wrote {out}; drive it with: costeer simulate --driver {out}")


def _draw(plot: Path, fit: DriverFit, record: TrialRecord) -> None:
    """Draw the fit on the population at the speed that was suggested, if recorded."""
    import numpy as np

    from costeer.base.files import write_text
    from costeer.validation.fitted_figure import fit_svg

    plot.parent.mkdir(parents=True, exist_ok=True)
    suggested = record.metadata.get("speed")
    if not isinstance(suggested, float):
        suggested = float(np.mean(record.columns["longitudinal_velocity"]))
    write_text(plot, fit_svg(fit, suggested))
    note(f"wrote {plot}")


def _print_tables(path: Path, fit: DriverFit, checks: list[Check]) -> None:
    print_table(
        ["parameter", "unit", "estimate", "95 % from", "to", "how"],
        [_estimate_row(each) for each in fit.estimates],
        f"Driver of {path}: {fit.lane_keeping:.0f} s of lane keeping, "
        f"{fit.num_changes} lane changes",
    )
    print_table(
        ["not identified", "why"], [[n.name, n.reason] for n in fit.not_identified]
    )
    compared = [c for c in checks if not c.reason]
    if compared:
        print_table(
            ["measure", "unit", "recorded", "simulated", "sd", ""],
            [
                [
                    c.measure,
                    c.unit,
                    *(f"{v:.3g}" for v in (c.recorded, c.mean, c.deviation)),
                    "more than 2 sd off" if c.flagged else "",
                ]
                for c in compared
            ],
            "The fitted driver in the same trial, with other noise",
        )
    for check in checks:
        if check.reason:
            typer.echo(f"not compared: {check.measure}: {check.reason}")
    for line in _notes(fit):
        note(f"note: {line}")


def _estimate_row(estimate: Estimate) -> list[str]:
    """An estimate in people's units."""
    from costeer.pages.units import shown

    unit, factor = shown(estimate.unit)
    numbers = (estimate.value, estimate.low, estimate.high)
    return [
        estimate.name,
        unit,
        *(f"{number * factor:.4g}" for number in numbers),
        estimate.how,
    ]


def _notes(fit: DriverFit) -> list[str]:
    """What the reader should know before trusting the numbers."""
    lines = list(fit.notes)
    if fit.whiteness > fit.white_limit:
        lines.append(
            f"prediction errors are correlated by up to {fit.whiteness:.3f}, those of "
            f"a driver of this model by less than {fit.white_limit:.3f}: the model "
            "does not describe this driver well, and the intervals are too narrow"
        )
    return lines


def _print_json(path: Path, fit: DriverFit, checks: list[Check]) -> None:
    import json

    from costeer.drivers.population import SECOND

    answer = {
        "file": str(path),
        "population": SECOND.version,
        "lane_keeping": fit.lane_keeping,
        "num_changes": fit.num_changes,
        "torque_noise": fit.torque_noise,
        "prediction_error": fit.prediction_error,
        "whiteness": fit.whiteness,
        "white_limit": fit.white_limit,
        "estimates": [e._asdict() for e in fit.estimates],
        "not_identified": [n._asdict() for n in fit.not_identified],
        "checks": [_plain(c) for c in checks],
        "notes": _notes(fit),
    }
    typer.echo(json.dumps(answer, indent=2, ensure_ascii=False))


def _plain(check: Check) -> dict[str, object]:
    """A check in JSON's own types: it has no NaN."""
    return {
        name: None if isinstance(value, float) and math.isnan(value) else value
        for name, value in check._asdict().items()
    }
