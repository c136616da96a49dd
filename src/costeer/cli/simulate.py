"""`costeer simulate`: one trial, its record, and a short account of it."""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from costeer.cli import plug_ins
from costeer.cli.console import hold_notes, note, release_notes
from costeer.cli.trial_summary import print_summary

if TYPE_CHECKING:
    from costeer.loop.scenario import TrialSetup


def simulate(
    out: Annotated[Path, typer.Option(help="Trial record to write, FILE.parquet.")],
    condition: Annotated[
        str,
        typer.Option(
            help="Condition: manual, or a strength and a duration, such as weak-gentle."
        ),
    ] = "strong-normal",
    seed: Annotated[
        int, typer.Option(help="Seed of driver, leading cars and noise.")
    ] = 1,
    participant: Annotated[
        int, typer.Option(help="Number of the driver within the population.")
    ] = 1,
    scenario: plug_ins.Scenario = "expressway",
    mistake: plug_ins.Mistakes = None,
    length: plug_ins.Length = None,
    speed: plug_ins.Speed = None,
    car: plug_ins.Car = "default",
    driver: plug_ins.Driver = "virtual",
    intention: Annotated[
        str,
        typer.Option(
            help="What tells the system of a lane change: network, scripted "
            "(the driver's own plan) or off."
        ),
    ] = "network",
    method: plug_ins.Method = "ibhs",
    predictor: plug_ins.PredictorName = "gru",
    weights: plug_ins.Weights = None,
    exact_network: plug_ins.ExactNetwork = False,
    assignments: plug_ins.Assignments = None,
    parameters: plug_ins.ParameterFile = None,
    trigger_at: Annotated[
        list[float] | None,
        typer.Option(
            metavar="S",
            help="Time at which the system starts a lane change, unless one "
            "is under way [s]; repeatable.",
        ),
    ] = None,
    events: Annotated[
        bool,
        typer.Option(
            "--events/--no-events", help="Place slower cars ahead, to be overtaken."
        ),
    ] = True,
    initial_offset: Annotated[
        float,
        typer.Option(
            metavar="M",
            help="Distance from the lane centre at the start [m], positive "
            "to the left.",
        ),
    ] = 0.0,
    engine: Annotated[
        str, typer.Option(help="Numerical engine: numba, python or jax.")
    ] = ("numba"),
) -> None:
    """Simulate one trial, write its record and summarise what happened.

    Example:
        costeer simulate --out out/trial.parquet --condition weak-gentle
        costeer simulate --out out/a.parquet --driver hands-off --trigger-at 20
        costeer simulate --out out/b.parquet --method my_method.py
        costeer simulate --out out/c.parquet --scenario expressway-curves
        costeer simulate --out out/d.parquet --mistake late-trigger=0.8
    """
    from costeer.loop.inputs import car_of, driver_of
    from costeer.loop.scenario import TrialSetup
    from costeer.methods.conditions import condition as condition_named

    hold_notes()
    course = plug_ins.chosen_scenario(scenario, length, speed)
    setup = TrialSetup(
        participant=participant,
        seed=seed,
        condition=condition_named(condition).name,
        method=method,
        length=course.length,
        speed=course.speed,
        scenario=course.scenario,
        car=car_of(car),
        driver=driver_of(driver),
        intention=intention,
        predictor=predictor,
        weights=plug_ins.weights_path(weights),
        exact_network=exact_network,
        parameters=plug_ins.values_with_threshold(
            parameters, assignments, plug_ins.Reader(predictor, weights, method)
        ),
        trigger_times=tuple(trigger_at or ()),
        events=events,
        initial_offset=initial_offset,
        mistakes=tuple(mistake or ()),
    )
    plug_ins.tell_of_bends([course.scenario], intention, predictor, weights)
    simulate_to_file(out, setup, engine)


def simulate_to_file(out: Path, setup: TrialSetup, engine: str = "numba") -> None:
    """Simulate a trial, write its record and print what happened.

    Args:
        out: File to write. A simulated trial is replaced, nothing else.
        setup: What the trial is.
        engine: `numba`, `python` or `jax`.

    Raises:
        ValueError: If the setup cannot be run, or the file is not to be replaced.
        OSError: If the file cannot be written.
    """
    from costeer.loop.scenario import check_setup, is_assisted
    from costeer.loop.trial import simulate_trial
    from costeer.records.record import write_record
    from costeer.scenarios.unmet import unmet

    check_setup(setup)
    if setup.trigger_times and not is_assisted(setup):
        raise ValueError(
            f"a lane change cannot be started in {setup.condition} with method "
            f"{setup.method}; choose an assisted condition for --trigger-at"
        )
    refuse_to_replace(out)
    refuse_other_names(out)
    release_notes()
    out.parent.mkdir(parents=True, exist_ok=True)
    record = simulate_trial(setup, engine)
    write_record(out, record)
    print_summary(record)
    _tell_late_triggers(setup, float(record.columns["time"][-1]))
    for line in unmet(record):
        note(f"costeer: {line}")
    typer.echo(out)


def _tell_late_triggers(setup: TrialSetup, end: float) -> None:
    """Say which lane changes were to start after the end of the trial [s]."""
    late = [time for time in setup.trigger_times if time > end]
    if late:
        note(
            f"costeer: --trigger-at {', '.join(f'{time:g}' for time in late)} had no "
            f"effect: the trial ended after {end:.1f} s; make --length longer"
        )


def refuse_other_names(out: Path) -> None:
    """Refuse a name by which nobody would take the file for Parquet.

    Raises:
        ValueError: If the name does not end in `.parquet`.
    """
    if out.suffix != ".parquet":
        raise ValueError(
            f"--out is {str(out)!r}; a record is a Parquet file: give a name that ends "
            "in .parquet"
        )


def refuse_to_replace(out: Path) -> None:
    """Refuse to overwrite what the same command could not make again.

    Raises:
        ValueError: If there is a folder, or a file that is no simulated trial.
    """
    from costeer.records.metadata import HANDS_OFF, VIRTUAL
    from costeer.records.record import read_record

    if not out.exists():
        return
    kind = ""
    if out.is_file():  # reading a device may never end
        with suppress(ValueError):
            kind = str(read_record(out, columns=["time"]).metadata["driver_kind"])
    if kind not in (VIRTUAL, HANDS_OFF):
        raise ValueError(
            f"{out} exists and is not a simulated trial; choose another --out"
        )
