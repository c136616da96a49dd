"""`costeer study`: the whole experiment with virtual drivers, then the report."""

from __future__ import annotations

import time
from collections import Counter
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from costeer.cli import plug_ins
from costeer.cli.console import hold_notes, note, release_notes
from costeer.cli.scaled import (
    Cluster,
    ShardOption,
    chosen_shard,
    end_if_failed,
    tell_merge,
)
from costeer.cli.trial_progress import study_progress

_LOOKED_AT = 60
"""Records in which it is looked for what the scenario had in store [-]."""

if TYPE_CHECKING:
    from costeer.scale.shard import Shard
    from costeer.study.configuration import StudySettings
    from costeer.study.run import Scale, StudyOutcome


def study(
    out: Annotated[
        Path, typer.Option(help="Folder of the study; an unfinished study is resumed.")
    ],
    participants: Annotated[int, typer.Option(help="Number of virtual drivers.")] = 12,
    conditions: Annotated[
        str,
        typer.Option(
            help="Conditions to drive, separated by commas, such as manual,weak-gentle."
        ),
    ] = "all",
    seed: Annotated[
        int, typer.Option(help="Seed of drivers, leading cars and noise.")
    ] = 1,
    jobs: Annotated[
        int | None,
        typer.Option(
            help="Number of trials run in parallel; by default one per processor."
        ),
    ] = None,
    method: plug_ins.Method = "ibhs",
    intention: Annotated[
        str,
        typer.Option(
            help="What tells the system of a lane change: network, or "
            "scripted (the driver's own decision)."
        ),
    ] = "network",
    scenario: plug_ins.Scenario = "expressway",
    mistake: plug_ins.Mistakes = None,
    length: plug_ins.Length = None,
    speed: plug_ins.Speed = None,
    car: plug_ins.Car = "default",
    driver: plug_ins.Drivers = None,
    predictor: plug_ins.PredictorName = "gru",
    weights: plug_ins.Weights = None,
    exact_network: plug_ins.ExactNetwork = False,
    assignments: plug_ins.Assignments = None,
    parameters: plug_ins.ParameterFile = None,
    report: Annotated[
        bool,
        typer.Option(help="Write tests, figures and report.html after the tables."),
    ] = True,
    cluster: Cluster = "",
    records: Annotated[
        bool, typer.Option(help="Keep the record of each trial, or only its measures.")
    ] = True,
    shard: ShardOption = "",
) -> None:
    """Run the whole experiment with virtual drivers, then the report.

    Each participant drives manually, then with guidance of each strength and duration.
    Stop it with Ctrl-C or kill it: the same command continues where it stopped, with
    the same results. They do not depend on --jobs, --cluster or --shard. A trial that
    fails is a row of failures.csv; the exit code is then 1.

    Example:
        costeer study --out out/study
        costeer study --out out/quick --participants 2 --length 2000 --no-report
        costeer study --out out/firm --set guidance.lateral_error_gain=3
        costeer study --out out/curves --scenario expressway-curves
        costeer study --out out/many --participants 1000 --no-records --cluster local:4
    """
    from costeer.methods.conditions import parse_conditions
    from costeer.scale.cluster import check_cluster
    from costeer.study.configuration import StudySettings, check_settings
    from costeer.study.run import Scale

    hold_notes()
    course = plug_ins.chosen_scenario(scenario, length, speed)
    settings = check_settings(
        StudySettings(
            participants=participants,
            conditions=parse_conditions(conditions),
            seed=seed,
            method=method,
            intention=intention,
            length=course.length,
            speed=course.speed,
            scenario=scenario,
            car=car,
            predictor=predictor,
            weights=plug_ins.weights_path(weights) or "",
            exact_network=exact_network,
            drivers=tuple(driver or ()),
            parameters=plug_ins.values_with_threshold(
                parameters, assignments, plug_ins.Reader(predictor, weights, method)
            ),
            mistakes=tuple(mistake or ()),
        )
    )
    _warn_if_unbalanced(settings)
    plug_ins.tell_of_bends([scenario], intention, predictor, weights)
    scale = Scale(
        cluster=check_cluster(cluster),
        records=records,
        shard=chosen_shard(shard),
    )
    outcome, seconds = _run(out, settings, jobs, report, scale)
    _print_outcome(outcome, seconds)
    _tell_unmet(outcome)
    _print_end(outcome, scale.shard, report)


def _tell_unmet(outcome: StudyOutcome) -> None:
    """Say what of the scenario the first drives with a record did not meet."""
    from costeer.records.record import read_record
    from costeer.scenarios.unmet import may_be_unmet, unmet
    from costeer.study.material import find_records

    paths = [*find_records(outcome.folder).values()][:_LOOKED_AT]
    if not paths or not may_be_unmet(read_record(paths[0], ()).metadata):
        return
    found = Counter(line for path in paths for line in unmet(read_record(path)))
    for line, times in found.most_common(5):
        note(f"costeer: in {times} of {len(paths)} drives: {line}")


def _warn_if_unbalanced(settings: StudySettings) -> None:
    from costeer.study.design import rows_needed

    rows = rows_needed(settings.conditions)
    if settings.participants % rows:
        note(
            f"costeer: the order of conditions is not balanced; give a multiple of "
            f"{rows} as --participants if it should be"
        )


def _run(
    out: Path, settings: StudySettings, jobs: int | None, report: bool, scale: Scale
) -> tuple[StudyOutcome, float]:
    """Run the study behind a progress display; say how to resume if it is stopped.

    Returns:
        What was done, and how long the trials took [s].
    """
    from costeer.scale.shard import part
    from costeer.study.run import StudyInterrupted, full_report, run_study
    from costeer.study.trials import TrialDone, study_trials

    begun = ended = time.monotonic()
    total = len(part(study_trials(settings), scale.shard))
    with study_progress(total) as display:

        def shown(done: TrialDone) -> None:
            nonlocal ended
            ended = time.monotonic()
            release_notes()
            display.trial(done)

        try:
            outcome = run_study(
                out,
                settings,
                jobs=jobs,
                report=partial(full_report, tell=display.step) if report else None,
                progress=shown,
                scale=scale,
            )
        except StudyInterrupted as stop:
            note(f"costeer: {stop}", at_once=True)
            raise
    return outcome, ended - begun


def _print_outcome(outcome: StudyOutcome, seconds: float) -> None:
    num_failed = len(outcome.failed)
    num_new = outcome.num_trials - outcome.num_resumed - num_failed
    typer.echo(f"{num_new} trials simulated, {outcome.num_resumed} were there")
    if num_new and seconds > 0:
        typer.echo(
            f"{outcome.driver_seconds:,.0f} driver-seconds in {seconds:.1f} s, "
            f"{outcome.driver_seconds / seconds:,.0f} per second"
        )


def _print_end(outcome: StudyOutcome, shard: Shard, report: bool) -> None:
    if shard.total == 1:
        typer.echo(outcome.folder / ("report.html" if report else "trials.csv"))
    else:
        tell_merge(shard, outcome.folder)
    end_if_failed(outcome)
