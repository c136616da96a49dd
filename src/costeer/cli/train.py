"""`costeer train`: fit the intention network on records."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Annotated

import typer

from costeer.cli.validate import at_least, in_range

FEWEST_DRIVERS = 3
"""One each for training, validation and test."""


def train(
    files: Annotated[
        list[Path] | None,
        typer.Argument(help="Trial records or tables (CSV, Parquet) to learn from."),
    ] = None,
    out: Annotated[Path, typer.Option(help="File of weights to write.")] = Path(
        "out/intention.npz"
    ),
    simulate: Annotated[
        int,
        typer.Option(
            help="Simulate manual trials of so many drivers.",
            callback=in_range(0, 10_000),
        ),
    ] = 0,
    seed: Annotated[
        int,
        typer.Option(help="Of drivers, split and first weights.", callback=at_least(0)),
    ] = 1,
    hidden: Annotated[
        int | None,
        typer.Option(
            help="Hidden units; chosen on validation drivers if not given.",
            callback=in_range(1, 256),
        ),
    ] = None,
    steps: Annotated[
        int | None,
        typer.Option(help="Training steps at most, per size.", callback=at_least(1)),
    ] = None,
    jobs: Annotated[
        int | None, typer.Option(help="Threads to simulate with.", callback=at_least(1))
    ] = None,
) -> None:
    """Fit the intention network on records.

    Drivers are dealt to training, validation and test; the last judge the result. Needs
    the extra `train` (JAX, Optax).

    Example:
        costeer train --simulate 60 --out out/intention.npz
    """
    if not files and not simulate:
        raise ValueError(
            "nothing to learn from: name trial records, or simulate drivers with "
            "--simulate 60"
        )
    if not files and simulate < FEWEST_DRIVERS:
        raise ValueError(
            f"--simulate {simulate} is too few: training, validation and test need "
            f"different drivers, at least {FEWEST_DRIVERS}"
        )
    from costeer.cli.console import note, progress
    from costeer.cli.evaluate import print_evaluation, print_notes
    from costeer.intention.weights import save_weights
    from costeer.training import train as training
    from costeer.training.dataset import simulate_recordings
    from costeer.training.recordings import read_recordings

    _check_place(out)
    parameters = training.DEFAULTS
    if hidden:
        parameters = parameters._replace(hidden_sizes=(hidden,))
    if steps:
        parameters = parameters._replace(fit=parameters.fit._replace(num_steps=steps))
    recordings = read_recordings(files or [])
    print_notes(recordings)
    if simulate:
        with progress("simulated drivers", simulate) as advance:
            recordings += simulate_recordings(
                simulate, seed, jobs or os.cpu_count() or 1, advance
            )
    total = parameters.fit.num_steps * len(parameters.hidden_sizes)
    with progress("training steps", total) as advance:
        network = training.train(
            recordings, seed, parameters, _source(files, simulate), advance
        )
    save_weights(out, network)
    note(f"hidden size {network.facts['hidden_size']}, hash {network.hash[:12]}: {out}")
    print_evaluation(network.facts["test"], "Drivers without part in the training")


def _source(files: list[Path] | None, simulate: int) -> str:
    """What the network learned from, in words."""
    from costeer.drivers.population import POPULATION_VERSION

    kind = f"simulated manual drivers of population {POPULATION_VERSION}"
    parts = [f"{simulate} {kind}"] if simulate else []
    parts += ["files " + ", ".join(file.name for file in files)] if files else []
    return " and ".join(parts)


def _check_place(out: Path) -> None:
    """Find out before the training whether its result can be written.

    Raises:
        ValueError: If the name is not of a file of weights.
        OSError: If it cannot be written.
    """
    if out.suffix != ".npz" or (out.exists() and not out.is_file()):
        raise ValueError(
            f"--out {out} cannot become a file of weights; give a file's name that "
            "ends in .npz"
        )
    out.parent.mkdir(parents=True, exist_ok=True)
    probe = out.with_name(f".{out.name}.probe")
    probe.touch()
    probe.unlink()
