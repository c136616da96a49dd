"""Shards of a comparison put together: every block once, then tables and report."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import ExitStack
from functools import partial
from pathlib import Path
from typing import NamedTuple

from costeer.comparison.configuration import comparison_configuration
from costeer.comparison.design import Block, ComparisonSettings, Plan, blocks_of
from costeer.comparison.folder import (
    COMPARE_FILE,
    ComparisonFolder,
    block_path,
    cell_name,
    opened_comparison,
    read_block,
    read_comparison,
    record_path,
    refuse_other,
)
from costeer.comparison.results import cells_from, scenario_in
from costeer.comparison.run import (
    ComparisonOutcome,
    block_done,
    full_report,
    prepared,
    summed,
)
from costeer.comparison.worst import write_worst
from costeer.loop.trial import simulate_trial
from costeer.scale.gathered import Found, copied, gathered
from costeer.study.folder import configuration_hash
from costeer.study.locks import locked
from costeer.study.trials import Simulate


class Merged(NamedTuple):
    """What a merge did.

    Attributes:
        outcome: Of the whole comparison.
        repeated: Blocks that several folders had, with the same bytes, in words.
    """

    outcome: ComparisonOutcome
    repeated: tuple[str, ...]


def merge_comparison(
    folders: Sequence[Path | str],
    out: Path | str | None = None,
    report: Callable[[Path], object] | None = full_report,
    *,
    settings: ComparisonSettings | None = None,
    simulate: Simulate = simulate_trial,
) -> Merged:
    """Write tables and report of a comparison whose shards are done.

    The worst drives are simulated again for their records, as at the end of a
    comparison that one process runs.

    Args:
        folders: The folder that the shards shared, or those of all of them.
        out: Where the comparison is put together; needed for several folders.
        report: Writes tables, figures and report; None for the results only.
        settings: Of the comparison, if methods were given as objects; else those that
            the folder tells.
        simulate: Makes the record of a trial.

    Raises:
        ValueError: If blocks are missing, a folder is another comparison's or in use,
            sources have changed since, or two folders have the same block with
            different results; it names them.
        OSError: If a file cannot be read or written.
    """
    there = [read_comparison(Path(each)) for each in folders]
    if not there:
        raise ValueError("there is nothing to merge: give the folders of the shards")
    for other in there[1:]:
        refuse_other(other, there[0])
    if out is None and len(there) > 1:
        raise ValueError(
            f"{len(there)} folders need one to be put together in; give --out DIR"
        )
    full, plan = prepared(settings or settings_in(there[0]), simulate)
    _refuse_changed(there[0], full, plan)
    home = there[0].path if out is None else Path(out)
    with ExitStack() as held:
        for each in there:
            if each.path.resolve() != home.resolve():
                held.enter_context(locked(each.path))
        chosen, repeated = _chosen(there)
        text = (there[0].path / COMPARE_FILE).read_text("utf-8")
        opened = opened_comparison(home, there[0].configuration, text)
        own = held.enter_context(opened)
        for block, found in chosen.items():
            _copy(own, block, found)
        write_worst(own, full, plan, simulate)
        if report is not None:
            report(home)
        done = [block_done(read_block(own, b) or [], resumed=True) for b in chosen]
    return Merged(summed(home, done), tuple(map(_told, repeated)))


def settings_in(folder: ComparisonFolder) -> ComparisonSettings:
    """The settings of the comparison in a folder.

    Raises:
        ValueError: If a method was given as an object, which no file can hold.
    """
    told = folder.configuration
    objects = [n for n, each in told["methods"].items() if each["given_as"] == _OBJECT]
    if objects:
        raise ValueError(
            f"{folder.path} compares {', '.join(objects)}, given as an object in "
            "Python; merge there, with costeer.comparison.merge.merge_comparison and "
            "settings="
        )
    lengths = {float(each["length"]) for each in told["scenarios"].values()}
    return ComparisonSettings(
        methods=tuple(each["given_as"] for each in told["methods"].values()),
        scenarios=tuple(scenario_in(*each) for each in told["scenarios"].items()),
        mistakes=tuple(told["mistakes"]),
        participants=int(told["participants"]),
        seed=int(told["seed"]),
        condition=str(told["condition"]),
        intention=str(told["intention"]),
        # Of courses with a length each, none was given for all.
        length=lengths.pop() if len(lengths) == 1 else None,
        keep_records=bool(told["keep_records"]),
    )


_OBJECT = "an object"


def _refuse_changed(
    there: ComparisonFolder, full: ComparisonSettings, plan: Plan
) -> None:
    """Refuse to drive worst cases by other sources than those of the results."""
    now = comparison_configuration(full, plan)
    refuse_other(there, ComparisonFolder(there.path, now, configuration_hash(now)))


def _chosen(
    folders: Sequence[ComparisonFolder],
) -> tuple[dict[Block, Found], list[Block]]:
    configuration = folders[0].configuration
    cells = cells_from(configuration)
    blocks = blocks_of(cells, int(configuration["participants"]))
    return gathered(blocks, partial(_places, folders), _told, "blocks of drivers")


def _places(folders: Sequence[ComparisonFolder], block: Block) -> list[Found]:
    found = []
    for each in folders:
        outcomes = read_block(each, block)
        if outcomes is not None:
            failed = any(outcome.failure for outcome in outcomes)
            found.append(Found(block_path(each.path, block), failed))
    return found


def _copy(own: ComparisonFolder, block: Block, found: Found) -> None:
    """Copy the results of a block, and its records if there are some."""
    source = found.file.parents[1]
    files = {block_path(own.path, block): found.file}
    for participant in block.participants:
        record = record_path(source, block.cell, participant)
        if record.exists():
            files[record_path(own.path, block.cell, participant)] = record
    copied(files)


def _told(block: Block) -> str:
    """A block in words."""
    first, last = block.participants[0], block.participants[-1]
    return f"{cell_name(block.cell)} drivers {first} to {last}"
