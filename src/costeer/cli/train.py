"""`costeer train`: fit the intention network, or its rivals, on records."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, NamedTuple

import typer

from costeer.cli.adapt import SHIPPED, Adapting, adapt_to_people, start_network
from costeer.cli.baselines import fit_baselines
from costeer.cli.bracket_check import check_form
from costeer.cli.reading import (
    AS_FOUND,
    Told,
    reads_tables,
    refuse_without_files,
    way_of,
)
from costeer.cli.validate import at_least, in_range, one_of, positive

if TYPE_CHECKING:
    from costeer.training.recordings import Recording

FEWEST_DRIVERS = 3
"""One each for training, validation and test."""

KINDS = ("network", "baselines")


class Source(NamedTuple):
    """What to learn from.

    Attributes:
        files: Trial records and tables.
        simulate: Simulated drivers.
        seed: Of these drivers.
        jobs: Threads to simulate with.
        dataset: Name of a set of real driving.
        data: Folder of the sets.
        resample: Bring tables of another rate to 60 Hz.
        told: How tables are to be read.
    """

    files: list[Path]
    simulate: int
    seed: int
    jobs: int
    dataset: str | None
    data: Path | None
    resample: bool
    told: Told = AS_FOUND


@reads_tables
def train(
    files: Annotated[
        list[Path] | None,
        typer.Argument(
            help="Trial records or tables (text, Parquet, Arrow) to learn from."
        ),
    ] = None,
    out: Annotated[Path, typer.Option(help="File to write the weights to.")] = Path(
        "out/intention.npz"
    ),
    simulate: Annotated[
        int,
        typer.Option(
            help="Number of virtual drivers whose manual trials to learn from.",
            callback=in_range(0, 10_000),
        ),
    ] = 0,
    dataset: Annotated[
        str | None,
        typer.Option(help="Data set of real driving to learn from, such as ngsim_lc."),
    ] = None,
    data: Annotated[
        Path | None,
        typer.Option(
            help="With --dataset: folder that holds the data sets; by default "
            "the one that the environment variable COSTEER_DATA names, else data."
        ),
    ] = None,
    resample: Annotated[
        bool,
        typer.Option(
            "--resample",
            help="Resample tables of another rate to 60 Hz, which delays "
            "them by a row.",
        ),
    ] = False,
    fit: Annotated[
        str,
        typer.Option(
            help="What to fit: the network, or the baselines it is compared with.",
            callback=one_of(KINDS),
        ),
    ] = "network",
    start: Annotated[
        str | None,
        typer.Option(
            metavar="shipped|FILE",
            help="Weights to fine-tune to the recordings.",
        ),
    ] = None,
    adapt: Annotated[
        Path | None,
        typer.Option(
            metavar="FOLDER",
            help="Folder with 10 min or more of recordings of the people to "
            "adapt to. The weights of --start are fine-tuned and calibrated, "
            "the threshold is set, and the result is judged on left-out drivers.",
        ),
    ] = None,
    false_per_km: Annotated[
        float | None,
        typer.Option(
            help="With --adapt: false triggers per kilometre that the "
            "threshold may cause; by default 0.05.",
            callback=positive("per km"),
        ),
    ] = None,
    seed: Annotated[
        int,
        typer.Option(
            help="Seed of the drivers, the split and the initial weights.",
            callback=at_least(0),
        ),
    ] = 1,
    hidden: Annotated[
        int | None,
        typer.Option(
            help="Number of hidden units; by default chosen on the validation drivers.",
            callback=in_range(1, 256),
        ),
    ] = None,
    steps: Annotated[
        int | None,
        typer.Option(
            help="Largest number of training steps for each network size; "
            "with --adapt, 0 only calibrates and sets the threshold.",
            callback=at_least(0),
        ),
    ] = None,
    jobs: Annotated[
        int | None,
        typer.Option(
            help="Number of threads for the simulation.", callback=at_least(1)
        ),
    ] = None,
    check_kilometres: Annotated[
        float | None,
        typer.Option(
            metavar="KM",
            help="Length of fresh simulated drives [km], such as 10000, on which to "
            "check the cheaper form of the network against the exact one; if it "
            "passes on 1000 or more, the simulation uses it.",
            callback=positive("km"),
        ),
    ] = None,
    told: Told = AS_FOUND,
) -> None:
    """Fit the intention network on records.

    The drivers are split into training, validation and test drivers; the result is
    judged on the test drivers. With --start, but without --adapt, all recordings are
    used for training and nothing is judged. Finished baselines are kept beside --out,
    so that the same command continues where it was stopped. Training needs the extra
    `train` (JAX, Optax, scikit-learn).

    Example:
        costeer train --simulate 60 --out out/intention.npz
        costeer train --simulate 60 --fit baselines --out out/baselines.npz
        costeer train drives.csv --start out/intention.npz --out out/tuned.npz
        costeer train --start shipped --adapt recordings --out out/ours.npz
        costeer train --simulate 60 --check-kilometres 10000 --out out/intention.npz
    """
    if adapt is not None:
        _refuse_beside_adapt(files, simulate, dataset, fit, hidden, check_kilometres)
        wanted = Adapting(adapt, start or SHIPPED, seed, steps, false_per_km, resample)
        _check_place(out)
        adapt_to_people(wanted, told, out)
        return
    if false_per_km is not None or steps == 0:
        raise ValueError("--false-per-km and --steps 0 are for --adapt FOLDER")
    threads = jobs or os.cpu_count() or 1
    source = Source(files or [], simulate, seed, threads, dataset, data, resample, told)
    _check_source(source, start is not None)
    _check_place(out)
    _check_together(fit, start, hidden, steps)
    if fit == "baselines":
        if check_kilometres:
            raise ValueError("--check-kilometres is for a network; leave out --fit")
        fit_baselines(_recordings(source), source.seed, _made_from(source), out)
        return
    if start is not None:
        _fine_tune(source, start, steps, out)
    else:
        _fit_network(source, hidden, steps, out)
    if check_kilometres:
        check_form(out, check_kilometres, threads)


def _check_together(
    fit: str, start: str | None, hidden: int | None, steps: int | None
) -> None:
    """Refuse options that have nothing to say to each other."""
    if start is not None and (hidden or fit != "network"):
        raise ValueError(
            "--start goes on with a network as it is: leave out --hidden and --fit"
        )
    if fit == "baselines" and (hidden or steps):
        raise ValueError(
            "--fit baselines chooses its own sizes: leave out --hidden and --steps"
        )


def _refuse_beside_adapt(
    files: list[Path] | None,
    simulate: int,
    dataset: str | None,
    fit: str,
    hidden: int | None,
    check_kilometres: float | None,
) -> None:
    """Refuse other recordings, and what only a new network has."""
    given = {
        "files": files,
        "--simulate": simulate,
        "--dataset": dataset,
        "--fit": fit != "network",
        "--hidden": hidden,
        "--check-kilometres": check_kilometres,
    }
    others = [name for name, value in given.items() if value]
    if others:
        raise ValueError(
            f"--adapt FOLDER says what to learn from and goes on with a network as it "
            f"is; leave out {', '.join(others)}"
        )


def _check_source(source: Source, tunes: bool) -> None:
    """Refuse a call that names nothing to learn from, or too little."""
    if not source.files and not source.simulate and source.dataset is None:
        raise ValueError(
            "nothing to learn from: name trial records, simulate drivers with "
            "--simulate 60, or take --dataset ngsim_lc --data FOLDER"
        )
    if (source.dataset is None) != (source.data is None):
        raise ValueError(
            "--dataset and --data go together: the name of a set and the folder that "
            "holds it"
        )
    refuse_without_files(bool(source.files), source.told)
    alone = not source.files and source.dataset is None
    if alone and not tunes and source.simulate < FEWEST_DRIVERS:
        raise ValueError(
            f"--simulate {source.simulate} is too few: training, validation and test "
            f"need different drivers, at least {FEWEST_DRIVERS}"
        )


def _recordings(source: Source) -> list[Recording]:
    """All that is to be learned from."""
    from costeer.cli.console import progress
    from costeer.cli.evaluate import print_notes
    from costeer.training.datasets.catalogue import read_dataset
    from costeer.training.recordings import read_recordings
    from costeer.training.simulation import simulate_recordings

    way = way_of(source.told)
    found = read_recordings(source.files, source.resample, way.adaptation, way.reading)
    if source.dataset is not None and source.data is not None:
        found += read_dataset(source.dataset, source.data)
    print_notes(found)
    if source.simulate:
        with progress("simulated drivers", source.simulate) as advance:
            found += simulate_recordings(
                source.simulate, source.seed, source.jobs, advance
            )
    return found


def _fit_network(
    source: Source, hidden: int | None, steps: int | None, out: Path
) -> None:
    """Fit networks of all sizes, choose one, judge it, write it."""
    from costeer.cli.console import note, progress
    from costeer.cli.evaluate import print_evaluation
    from costeer.intention.weights import save_weights
    from costeer.training import train as training

    parameters = training.DEFAULTS
    if hidden:
        parameters = parameters._replace(hidden_sizes=(hidden,))
    if steps:
        parameters = parameters._replace(fit=parameters.fit._replace(num_steps=steps))
    recordings = _recordings(source)
    total = parameters.fit.num_steps * len(parameters.hidden_sizes)
    with progress("training steps", total) as advance:
        network = training.train(
            recordings, source.seed, parameters, _told(source), advance
        )
    save_weights(out, network)
    note(f"hidden size {network.facts['hidden_size']}, hash {network.hash[:12]}: {out}")
    print_evaluation(network.facts["test"], "Drivers without part in the training")


def _made_from(source: Source) -> dict[str, str]:
    """What decides the fits besides what the recordings hold, by name."""
    from costeer.scale.worker import sources_of

    package = Path(__file__).parents[1]
    rooms = ("training", "intention")
    return {
        "--seed": str(source.seed),
        "--simulate": str(source.simulate),
        "--dataset": str(source.dataset),
        "source of the fits": " ".join(sources_of(package / room) for room in rooms),
    }


def _fine_tune(source: Source, start: str, steps: int | None, out: Path) -> None:
    """Let a network learn from all recordings for some steps."""
    from costeer.cli.console import note
    from costeer.intention.weights import intention_network, save_weights
    from costeer.training.tuning import DEFAULTS, fine_tuned

    network = start_network(start)
    parameters = DEFAULTS._replace(num_steps=steps) if steps else DEFAULTS
    recordings = _recordings(source)
    weights = fine_tuned(network.weights, recordings, source.seed, parameters)
    facts = {
        "source": f"{_told(source)}, from weights {network.hash[:12]}",
        "seed": source.seed,
        "hidden_size": network.facts.get("hidden_size"),
        "start": {"hash": network.hash, "source": network.facts.get("source")},
        "steps": parameters.num_steps,
        "drivers": {"training": sorted({r.driver for r in recordings})},
    }
    tuned = intention_network(weights, facts)
    save_weights(out, tuned)
    note(f"hash {tuned.hash[:12]}: {out}; judge it on recordings it has not seen")


def _told(source: Source) -> str:
    """What the network learned from, in words."""
    from costeer.drivers.population import POPULATION_VERSION

    kind = f"simulated manual drivers of population {POPULATION_VERSION}"
    parts = [f"{source.simulate} {kind}"] if source.simulate else []
    if source.files:
        parts.append("files " + ", ".join(file.name for file in source.files))
    parts += [f"set {source.dataset}"] if source.dataset else []
    return " and ".join(parts)


def _check_place(out: Path) -> None:
    """Find out before the training whether its result can be written.

    Raises:
        ValueError: If the name is not of a file of weights.
        OSError: If it cannot be written.
    """
    from costeer.base.files import try_writing

    if out.suffix != ".npz" or (out.exists() and not out.is_file()):
        raise ValueError(
            f"--out {out} cannot become a file of weights; give a file's name that "
            "ends in .npz"
        )
    try_writing(out)
