"""A comparison from the first trial to the report: run, stop, resume.

A block of drivers is a job: each of its trials is simulated and measured, and the small
results are written together. Nothing depends on which job runs when, and what is kept
in memory does not grow with the number of drivers.
"""

from __future__ import annotations

import shlex
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import NamedTuple

import numpy as np

from costeer.comparison.configuration import comparison_configuration
from costeer.comparison.design import (
    Block,
    ComparisonSettings,
    Plan,
    checked,
    planned,
    setup_of,
)
from costeer.comparison.folder import (
    ComparisonFolder,
    comparison_text,
    opened_comparison,
    read_block,
    record_path,
    write_block,
)
from costeer.comparison.measures import COLUMNS, TrialOutcome, failed, outcome_of
from costeer.comparison.worst import write_worst
from costeer.loop.trial import simulate_trial
from costeer.methods.registry import METHODS
from costeer.records.record import write_record
from costeer.scale.cluster import workers
from costeer.scale.jobs import JobsStoppedError, Pool, run_jobs
from costeer.scale.shard import WHOLE, Shard, part
from costeer.study.run import StudyInterrupted, ignore
from costeer.study.trials import LENGTH_OF_TRY, Simulate

USUAL = ComparisonSettings()
"""All methods, six scenarios, 50 drivers."""


class Placement(NamedTuple):
    """Where the work is done, and which part of it; no result depends on it.

    Attributes:
        cluster: Whose workers drive, as `local:4`; empty for threads here.
        shard: Part of the blocks, for one job of many.
    """

    cluster: str = ""
    shard: Shard = WHOLE


HERE = Placement()


class BlockDone(NamedTuple):
    """A block whose results are on disk.

    Attributes:
        num_trials: Of it.
        num_failed: Of them, without a result.
        driver_seconds: That they lasted [s].
        resumed: Whether the results were there before.
        outcomes: That are not written yet.
    """

    num_trials: int
    num_failed: int
    driver_seconds: float
    resumed: bool
    outcomes: Sequence[TrialOutcome] = ()


class ComparisonOutcome(NamedTuple):
    """What a run of the comparison did.

    Attributes:
        folder: Where everything lies.
        num_trials: Of the comparison, or of the shard.
        num_resumed: Of them, not simulated again.
        num_failed: Of them, without a result.
        driver_seconds: Simulated in this run [s].
    """

    folder: Path
    num_trials: int
    num_resumed: int
    num_failed: int
    driver_seconds: float


def full_report(folder: Path, tell: Callable[[str], None] = ignore) -> None:
    """Write tables, figures and `report.html` of a comparison.

    Args:
        folder: Of the comparison.
        tell: Called with a few words before each step.
    """
    from costeer.comparison.report import write_report  # matplotlib takes a second

    write_report(folder, tell)


def prepared(
    settings: ComparisonSettings, simulate: Simulate = simulate_trial
) -> tuple[ComparisonSettings, Plan]:
    """The settings in full and everything that is driven.

    What comes from outside costeer is driven a few metres, so that what does not run is
    refused before there is a folder.

    Raises:
        ValueError: If a setting or a plug-in cannot be.
        OSError: If a file cannot be read.
    """
    full = checked(settings)
    plan = planned(full)
    tried = set()
    for cell in plan.cells:
        ours = isinstance(cell.entrant.given, str) and cell.entrant.given in METHODS
        if ours or cell.entrant.name in tried:
            continue
        tried.add(cell.entrant.name)
        simulate(setup_of(full, cell, 1)._replace(length=LENGTH_OF_TRY))
    return full, plan


def run_comparison(
    out: Path | str,
    settings: ComparisonSettings = USUAL,
    *,
    jobs: int | None = None,
    placement: Placement = HERE,
    report: Callable[[Path], object] | None = full_report,
    progress: Callable[[BlockDone], None] = ignore,
    simulate: Simulate = simulate_trial,
) -> ComparisonOutcome:
    """Compare methods, or finish a comparison that was begun in the folder.

    Args:
        out: Folder; `docs/compare.md` says what it will hold.
        settings: What to compare.
        jobs: Blocks at the same time; as many as processors if None. The results do
            not depend on it.
        placement: Cluster and shard. A shard writes no table and no report:
            `merge_comparison` does when all are there.
        report: Writes tables, figures and report; None for the results only.
        progress: Called in this thread with each block that is done.
        simulate: Makes the record of a trial.

    Raises:
        ValueError: If a setting is out of range, or the folder is another
            comparison's or in use.
        OSError: If a file cannot be written; finished blocks are kept.
        StudyInterrupted: If the user stopped it; finished blocks are kept.
    """
    full, plan = prepared(settings, simulate)
    configuration = comparison_configuration(full, plan)
    text = comparison_text(configuration, comparison_command(settings))
    blocks = part(plan.blocks, placement.shard)
    with (
        workers(jobs, placement.cluster) as pool,
        opened_comparison(Path(out), configuration, text, placement.shard) as folder,
    ):
        work = partial(drive_block, folder, full, simulate)
        done = _all_done(folder, blocks, work, pool, progress)
        if placement.shard.total == 1:
            write_worst(folder, full, plan, simulate)
            if report is not None:
                report(folder.path)
    return summed(folder.path, done)


def summed(path: Path, done: Sequence[BlockDone]) -> ComparisonOutcome:
    """What there is, in numbers."""
    return ComparisonOutcome(
        folder=path,
        num_trials=sum(each.num_trials for each in done),
        num_resumed=sum(each.num_trials for each in done if each.resumed),
        num_failed=sum(each.num_failed for each in done),
        driver_seconds=sum(each.driver_seconds for each in done if not each.resumed),
    )


def drive_block(
    folder: ComparisonFolder,
    settings: ComparisonSettings,
    simulate: Simulate,
    block: Block,
) -> BlockDone:
    """Simulate and measure the trials of a block; a worker elsewhere can do it.

    Raises:
        OSError: If a record that is to be kept cannot be written.
    """
    drive = partial(_outcome, folder, settings, simulate, block)
    outcomes = [drive(participant) for participant in block.participants]
    return block_done(outcomes, resumed=False)._replace(outcomes=outcomes)


def block_done(outcomes: Sequence[TrialOutcome], resumed: bool) -> BlockDone:
    """What the results of a block come to."""
    lasted = COLUMNS.index("duration")
    return BlockDone(
        num_trials=len(outcomes),
        num_failed=sum(bool(each.failure) for each in outcomes),
        driver_seconds=float(np.nansum([each.values[lasted] for each in outcomes])),
        resumed=resumed,
    )


def _outcome(
    folder: ComparisonFolder,
    settings: ComparisonSettings,
    simulate: Simulate,
    block: Block,
    participant: int,
) -> TrialOutcome:
    """Simulate and measure a trial; one that cannot be driven says why."""
    try:
        record = simulate(setup_of(settings, block.cell, participant))
        outcome = outcome_of(participant, record)
    except (OSError, MemoryError):
        raise
    except Exception as error:  # whatever the code of a rival raises
        return failed(participant, f"{type(error).__name__}: {error}")
    if settings.keep_records:
        path = record_path(folder.path, block.cell, participant)
        path.parent.mkdir(parents=True, exist_ok=True)
        write_record(path, record)
    return outcome


def _all_done(
    folder: ComparisonFolder,
    blocks: Sequence[Block],
    work: Callable[[Block], BlockDone],
    pool: Pool,
    progress: Callable[[BlockDone], None],
) -> list[BlockDone]:
    """Drive the blocks whose results are not there; write each as it comes."""
    done: list[BlockDone] = []
    missing: list[Block] = []
    for block in blocks:
        there = read_block(folder, block)
        if there is None or any(each.failure for each in there):
            missing.append(block)
            continue
        done.append(block_done(there, resumed=True))
        progress(done[-1])

    def keep(block: Block, driven: BlockDone) -> BlockDone:
        write_block(folder, block, driven.outcomes)
        return driven._replace(outcomes=())

    try:
        return done + run_jobs(work, missing, pool, progress, keep)
    except JobsStoppedError as stop:
        kept = (
            f"{len(done) + stop.num_done} of {len(blocks)} blocks are done and "
            f"kept in {folder.path}; run the same command again to go on from there"
        )
        cause = stop.__cause__
        if isinstance(cause, KeyboardInterrupt):
            raise StudyInterrupted(kept) from None
        if isinstance(cause, OSError):
            raise OSError(f"{cause}; {kept}") from cause
        raise cause or AssertionError("jobs stopped without a cause") from None


def comparison_command(settings: ComparisonSettings) -> str:
    """What runs this comparison; the folder is left to fill in."""
    words = ["costeer", "compare", "--out", "FOLDER"]
    for name, value in settings._asdict().items():
        if value == getattr(USUAL, name):
            continue
        if name == "keep_records":
            words.append("--keep-records")
        elif isinstance(value, tuple):
            told = [each if isinstance(each, str) else each.name for each in value]
            words += [f"--{name}", ",".join(told)]
        else:
            words += [f"--{name}", str(value)]
    return shlex.join(words)
