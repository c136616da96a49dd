"""`costeer compare`: methods side by side on the same drivers and roads."""

from __future__ import annotations

import time
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from costeer.cli import plug_ins
from costeer.cli.compiling import compiled_for
from costeer.cli.console import hold_notes, note, progress
from costeer.cli.scaled import (
    FAILED,
    Cluster,
    ShardOption,
    chosen_shard,
    tell_merge,
)
from costeer.cli.units import parse_length

if TYPE_CHECKING:
    from costeer.comparison.design import ComparisonSettings
    from costeer.comparison.run import BlockDone, ComparisonOutcome, Placement
    from costeer.loop.scenario import TrialSetup
    from costeer.records.columns import TrialRecord
    from costeer.scale.shard import Shard


def compare(
    out: Annotated[
        Path,
        typer.Option(help="Folder of the comparison; an unfinished one is resumed."),
    ],
    methods: Annotated[
        str,
        typer.Option(
            help="Methods to compare, separated by commas: names from "
            "`costeer methods`, FILE.py or module:object."
        ),
    ] = "all",
    scenarios: Annotated[
        str | None,
        typer.Option(
            help="Scenarios to drive, separated by commas: names from "
            "`costeer scenario list`, or FILE.yaml.",
            show_default="six of them",
        ),
    ] = None,
    mistakes: Annotated[
        str,
        typer.Option(
            help="Mistakes to make on purpose, separated by commas, or all; "
            "each trial has one at most."
        ),
    ] = "none",
    participants: Annotated[int, typer.Option(help="Number of virtual drivers.")] = 50,
    seed: Annotated[int, typer.Option(help="Seed of drivers, traffic and noise.")] = 1,
    condition: Annotated[
        str, typer.Option(help="Strength and lane-change duration of the guidance.")
    ] = "strong-normal",
    intention: Annotated[
        str,
        typer.Option(
            help="What tells the system of a lane change: scripted (the "
            "driver's own plan), network or off."
        ),
    ] = "scripted",
    length: Annotated[
        float | None,
        typer.Option(
            parser=parse_length,
            show_default="of each scenario",
            metavar="LENGTH",
            help="Length of every course [m], or with a unit, such as 3km.",
        ),
    ] = None,
    jobs: Annotated[
        int | None,
        typer.Option(
            help="Number of blocks of drivers run in parallel; by default "
            "one per processor."
        ),
    ] = None,
    cluster: Cluster = "",
    shard: ShardOption = "",
    keep_records: Annotated[
        bool, typer.Option("--keep-records", help="Keep the record of every trial.")
    ] = False,
) -> None:
    """Compare methods of assistance on the same drivers, roads and noise.

    Every method drives with every driver, scenario and mistake, so that differences are
    paired. Writes a report with winners and ties, effects, trade-offs and worst cases,
    and a table with a row for each trial. Stop it with Ctrl-C or kill it: the same
    command continues where it stopped. The results do not depend on --jobs, --cluster
    or --shard.

    Example:
        costeer compare --out out/compare
        costeer compare --out out/two --methods manual,ibhs --participants 10
        costeer compare --out out/mine --methods manual,ibhs,mine.py --length 3km
    """
    from costeer.comparison.design import SCENARIOS, ComparisonSettings
    from costeer.comparison.run import Placement
    from costeer.scenarios.mistakes import MISTAKES

    settings = ComparisonSettings(
        methods=() if methods.strip() == "all" else _words(methods, "methods"),
        scenarios=SCENARIOS if scenarios is None else _words(scenarios, "scenarios"),
        mistakes=tuple(MISTAKES)
        if mistakes.strip() == "all"
        else _words(mistakes, "mistakes"),
        participants=participants,
        seed=seed,
        condition=condition,
        intention=intention,
        length=length,
        keep_records=keep_records,
    )
    plug_ins.tell_of_bends(settings.scenarios, intention)
    part = chosen_shard(shard)
    outcome, seconds = _run(out, settings, jobs, Placement(cluster, part))
    _print_outcome(outcome, seconds, part)


def _words(text: str, option: str) -> tuple[str, ...]:
    """The names in an option.

    Raises:
        ValueError: If there is none.
    """
    found = tuple(word.strip() for word in text.split(",") if word.strip())
    if not found:
        raise ValueError(f"--{option} names nothing; give names with commas between")
    return found


def _tell(words: str) -> None:
    note(f"report: {words}")


def _run(
    out: Path, settings: ComparisonSettings, jobs: int | None, placement: Placement
) -> tuple[ComparisonOutcome, float]:
    """Run the comparison behind a progress display.

    Returns:
        What was done, and how long it took [s].
    """
    from costeer.comparison.design import num_trials
    from costeer.comparison.run import full_report, prepared, run_comparison
    from costeer.loop.trial import simulate_trial
    from costeer.scale.shard import part
    from costeer.study.run import StudyInterrupted

    hold_notes()
    _, plan = prepared(settings)
    for each in plan.left_out:
        note(f"costeer: {each.method} with {each.mistake} is left out: {each.reason}")
    for words in plan.notes:
        note(f"costeer: {words}")
    begun = time.monotonic()
    blocks = part(plan.blocks, placement.shard)
    with progress("trials", num_trials(blocks)) as advance:

        def shown(done: BlockDone) -> None:
            advance(done.num_trials)

        try:
            outcome = run_comparison(
                out,
                settings,
                jobs=jobs,
                placement=placement,
                report=partial(full_report, tell=_tell),
                progress=shown,
                simulate=simulate_trial
                if placement.cluster
                else partial(_told_of, [each.name for each in plan.entrants]),
            )
        except StudyInterrupted as stop:
            note(f"costeer: {stop}", at_once=True)
            raise
    return outcome, time.monotonic() - begun


def _told_of(waiting: list[str], setup: TrialSetup) -> TrialRecord:
    """Simulate a trial; should that need machine code, its method can be named.

    Args:
        waiting: Methods that nobody has driven yet; the one of the trial is removed.
        setup: The trial.
    """
    from costeer.loop.trial import simulate_trial
    from costeer.methods.registry import method_named

    name = method_named(setup.method).name
    if name in waiting:
        waiting.remove(name)
    compiled_for(f"method {name}", len(waiting))
    return simulate_trial(setup)


def _print_outcome(outcome: ComparisonOutcome, seconds: float, shard: Shard) -> None:
    num_new = outcome.num_trials - outcome.num_resumed
    typer.echo(f"{num_new} trials simulated, {outcome.num_resumed} were there")
    if num_new and seconds > 0:
        typer.echo(f"{outcome.driver_seconds:,.0f} driver-seconds in {seconds:.1f} s")
    if shard.total == 1:
        typer.echo(outcome.folder / "report.html")
    else:
        tell_merge(shard, outcome.folder)
    if outcome.num_failed:
        says = "exclusions.csv says why, and the" if shard.total == 1 else "the"
        note(
            f"costeer: {outcome.num_failed} trials failed; {says} same command tries "
            "them again"
        )
        raise typer.Exit(FAILED)
