"""`costeer session power` and `rehearse`: a study tried before anybody takes part."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import numpy as np
import typer

from costeer.cli.console import note, print_table


def _short(value: float) -> str:
    return f"{value:.4g}"


class Rehearsal(NamedTuple):
    """What is rehearsed, in words."""

    participants: int
    seed: int
    accidents: float
    haste: float | None
    conditions: str
    length: float
    scenario: str


def power(
    folder: Path, plan: Path | None, drivers: int, seed: int, intention: str
) -> None:
    """Say how many participants detect which effect, as virtual drivers predict it.

    Raises:
        ValueError: If there is no plan, or it cannot be.
        OSError: If a file cannot be read or written.
    """
    from costeer.base.files import write_text
    from costeer.cli.console import progress
    from costeer.sessions.plan_file import plan_file_in, read_plan
    from costeer.sessions.power import PowerSettings, compared_steps, planned_power

    found = read_plan(plan or plan_file_in(folder))
    settings = PowerSettings(drivers=drivers, seed=seed, intention=intention)
    total = drivers * len(compared_steps(found))
    beside = plan.parent if plan else folder
    with progress("trials", total) as advance:
        powers = planned_power(found, settings, lambda *_: advance(1), beside)
    planned = found.participants
    rows, lines = [], ["measure,condition,d_z,low,high,participants,power,low,high"]
    for each in powers:
        at = min(range(len(each.sizes)), key=lambda k: abs(each.sizes[k] - planned))
        shown = f"{each.power[at]:.2f} ({each.low[at]:.2f} to {each.high[at]:.2f})"
        needed = f"over {each.sizes[-1]}" if each.needed is None else str(each.needed)
        interval = f"({each.effect_low:.2f} to {each.effect_high:.2f})"
        size = f"{each.effect:.2f} {interval}"
        rows.append([each.measure, each.condition, size, shown, needed])
        for k, n in enumerate(each.sizes):
            numbers = (each.effect, each.effect_low, each.effect_high)
            power = (each.power[k], each.low[k], each.high[k])
            told = [
                *(f"{v:.4g}" for v in numbers),
                str(n),
                *(f"{v:.4g}" for v in power),
            ]
            lines.append(",".join([each.measure, each.condition, *told]))
    print_table(
        ["measure", "against manual", "d_z", f"power at {planned}", "80 % needs"], rows
    )
    folder.mkdir(parents=True, exist_ok=True)
    write_text(folder / "power.csv", "\n".join(lines) + "\n")
    typer.echo(folder / "power.csv")
    note(
        f"costeer: a prediction by {drivers} virtual drivers, calibrated on manual "
        "driving; brackets are 95 % intervals over these drivers. People may differ"
    )


def rehearse_study(folder: Path, said: Rehearsal) -> None:
    """Rehearse a study, print what came of it.

    Raises:
        typer.Exit: With 1 if something was lost.
    """
    from costeer.methods.conditions import parse_conditions
    from costeer.sessions.rehearse import rehearse
    from costeer.sessions.robot import RehearsalSettings

    usual = RehearsalSettings()
    settings = RehearsalSettings(
        participants=said.participants,
        seed=said.seed,
        accidents=said.accidents,
        haste=usual.haste if said.haste is None else said.haste,
        length=said.length,
        conditions=parse_conditions(said.conditions) if said.conditions else (),
        scenario=said.scenario,
    )
    found = rehearse(folder, settings, lambda text: note(f"costeer: {text}"))
    killed = ", ".join(f"{what} {n}" for what, n in found.accidents.items())
    print_table(
        ["what", "found"],
        [
            ["participants who finished", str(found.participants)],
            ["answers, of them lost", f"{found.answers}, {found.lost_answers}"],
            ["finished drives, of them lost", f"{found.trials}, {found.lost_trials}"],
            ["killed on the way", killed],
            ["orders balanced", "yes" if found.even else "no"],
            ["the console waits while someone drives", _waits_told(found.waits)],
            ["time", f"{found.seconds / 60.0:.1f} min"],
        ],
    )
    lost = found.lost_answers + found.lost_trials
    if lost or found.participants < said.participants:
        raise typer.Exit(1)


def _waits_told(waits: tuple[float, ...]) -> str:
    """Median and 95th percentile of waiting times [s], in words."""
    if not waits:
        return "nobody drove"
    middle, late = 1e3 * np.quantile(waits, [0.5, 0.95])
    return f"{middle:.0f} ms at the median, {late:.0f} ms at the 95th percentile"
