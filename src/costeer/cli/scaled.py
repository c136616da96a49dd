"""What commands whose work is trials share: the cluster, and trials that failed."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from costeer.cli.console import note

if TYPE_CHECKING:
    from costeer.study.run import StudyOutcome

FAILED = 1
"""Exit code of a study that went on without trials that failed."""

Cluster = Annotated[
    str,
    typer.Option(
        metavar="ADDRESS",
        help="Workers elsewhere: local:N for N processes here, tcp://host:8786 of a "
        "Dask scheduler, or ray:N, ray://host:10001.",
    ),
]


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
