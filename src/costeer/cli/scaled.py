"""What commands whose work is trials share: the cluster, and trials that failed."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from costeer.cli.console import note

if TYPE_CHECKING:
    from costeer.scale.shard import Shard
    from costeer.study.run import StudyOutcome

FAILED = 1
"""Exit code of a study that went on without trials that failed."""

Cluster = Annotated[
    str,
    typer.Option(
        metavar="ADDRESS",
        help="Run on a cluster: local:N for N processes here, "
        "tcp://host:8786 for a Dask scheduler, ray:N or "
        "ray://host:10001 for Ray.",
    ),
]

ShardOption = Annotated[
    str,
    typer.Option(
        "--shard",
        metavar="I/N",
        help="Do one part of the work, such as 3/20, or slurm for the "
        "part of a job array; costeer merge joins the parts.",
    ),
]


def chosen_shard(text: str) -> Shard:
    """The shard that `--shard` names; the whole without it.

    Raises:
        ValueError: If it names none.
    """
    from costeer.scale.shard import WHOLE, parse_shard

    return parse_shard(text, os.environ) if text else WHOLE


def tell_merge(shard: Shard, folder: Path) -> None:
    """Say that a shard is done, and how the whole comes of it."""
    note(
        f"costeer: shard {shard.number}/{shard.total} is done; when all are: "
        f"costeer merge {folder}"
    )


def end_if_failed(outcome: StudyOutcome) -> None:
    """Say which trials failed, and end with `FAILED` if one did.

    Raises:
        typer.Exit: If one did.
    """
    if not outcome.failed:
        return
    first = outcome.failed[0]
    more = len(outcome.failed) - 1
    note(
        f"costeer: {len(outcome.failed)} of {outcome.num_trials} trials failed: "
        f"participant {first.participant}, {first.condition}: {first.reason}"
        f"{f', and {more} more' if more else ''}; the same command tries them again"
    )
    raise typer.Exit(FAILED)
