"""`costeer sensitivity`: which parameters of the guidance decide what."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from costeer.cli.console import note, progress
from costeer.cli.scaled import Cluster, ShardOption, chosen_shard, tell_merge


def sensitivity(
    out: Annotated[
        Path, typer.Option(help="Folder of the analysis; an unfinished one is resumed.")
    ],
    samples: Annotated[
        int,
        typer.Option(
            help="Number of base samples, a power of two; 11 times as many are driven."
        ),
    ] = 128,
    drivers: Annotated[
        int, typer.Option(help="Number of pilot drivers for each sample.")
    ] = 4,
    length: Annotated[float, typer.Option(help="Length of the course [m].")] = 4000.0,
    seed: Annotated[
        int, typer.Option(help="Seed of the samples and the intervals.")
    ] = 1,
    jobs: Annotated[
        int | None,
        typer.Option(help="Number of threads; by default one per processor."),
    ] = None,
    cluster: Cluster = "",
    shard: ShardOption = "",
) -> None:
    """Find which guidance parameters matter most, by Sobol indices.

    Nine parameters are varied together, between bounds with sources, and driven by
    pilot drivers who take part in no study. Writes tables and a report with curves to
    choose by; no default is changed. Stop it with Ctrl-C: the same command continues
    where it stopped.

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
