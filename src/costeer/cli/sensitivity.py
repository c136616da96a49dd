"""`costeer sensitivity`: which parameters of the guidance decide what."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from costeer.cli.console import note, progress
from costeer.cli.scaled import Cluster, ShardOption, chosen_shard, tell_merge


def sensitivity(
    out: Annotated[
        Path, typer.Option(help="Folder; an unfinished analysis is resumed.")
    ],
    samples: Annotated[
        int, typer.Option(help="Base samples, a power of two; times 11 are driven.")
    ] = 128,
    drivers: Annotated[int, typer.Option(help="Pilot drivers for each.")] = 4,
    length: Annotated[float, typer.Option(help="Of the course [m].")] = 4000.0,
    seed: Annotated[int, typer.Option(help="Of the samples and intervals.")] = 1,
    jobs: Annotated[
        int | None, typer.Option(help="Threads; as many as processors if not given.")
    ] = None,
    cluster: Cluster = "",
    shard: ShardOption = "",
) -> None:
    """Find which parameters of the guidance decide what, by Sobol indices.

    Nine of them are varied at once between bounds with sources, and driven by pilot
    drivers who are in no study. Writes a report with curves to choose by, and tables.
    It changes no default. Stop it with Ctrl-C: the same command goes on from there.

    Example:
        costeer sensitivity --out out/sensitivity
        costeer sensitivity --out out/quick --samples 4 --drivers 1 --length 1500
    """
    from costeer.scale.cluster import workers
    from costeer.scale.shard import part
    from costeer.sensitivity.factors import FACTORS
    from costeer.sensitivity.report import write_report
    from costeer.sensitivity.run import Settings, check_settings, drive_all

    settings = check_settings(Settings(samples, drivers, length, seed))
    share = chosen_shard(shard)
    total = len(part(range(settings.base * (len(FACTORS) + 2)), share))
    try:
        with workers(jobs, cluster) as pool, progress("samples", total) as advance:
            outcomes = drive_all(out, settings, pool, advance, shard=share)
    except KeyboardInterrupt:
        note(f"costeer: what is done is kept in {out}; run the same command again")
        raise
    if share.total > 1:
        tell_merge(share, out)
        return
    typer.echo(write_report(out, settings, outcomes))
