"""`costeer train --adapt FOLDER`: the network as it suits the people of one lab."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from costeer.cli.console import note, print_table, progress
from costeer.cli.many import drives
from costeer.cli.reading import Told, way_of

if TYPE_CHECKING:
    from costeer.intention.weights import IntentionNetwork
    from costeer.training.recordings import Recording

SHIPPED = "shipped"


class Adapting(NamedTuple):
    """What was asked for.

    Attributes:
        folder: Of recordings, or of one of the public sets by its name.
        start: `SHIPPED` or a file of weights.
        seed: Of parts and order.
        steps: At most; None for as many as usual.
        false_per_km: That the threshold keeps to [1/km]; None for the usual.
        resample: Bring tables of another rate to 60 Hz.
    """

    folder: Path
    start: str
    seed: int
    steps: int | None
    false_per_km: float | None
    resample: bool


def start_network(start: str) -> IntentionNetwork:
    """The weights to go on from.

    Raises:
        ValueError: If there is no such file, or it does not hold such weights.
        OSError: If it cannot be read.
    """
    from costeer.intention.weights import load_weights

    if start == SHIPPED:
        return load_weights()
    if not Path(start).is_file():
        raise ValueError(
            f"--start {start} is no file; give {SHIPPED} or a FILE.npz of `costeer "
            "train`"
        )
    return load_weights(Path(start))


def adapt_to_people(wanted: Adapting, told: Told, out: Path) -> None:
    """Adapt a network, judge it on drivers left out, write it.

    Raises:
        ValueError: If the recordings do not suffice.
        OSError: If a file cannot be read or written.
    """
    from costeer.cli.evaluate import print_notes
    from costeer.intention.weights import intention_network, save_weights
    from costeer.training.adapt import adapt, check, num_fits
    from costeer.training.adaptation import DEFAULTS

    parameters = DEFAULTS
    if wanted.steps is not None:
        fit = parameters.fit._replace(num_steps=wanted.steps)
        parameters = parameters._replace(fit=fit)
    if wanted.false_per_km is not None:
        parameters = parameters._replace(false_per_km=wanted.false_per_km)
    start = start_network(wanted.start)
    recordings, data = _read(wanted, told)
    print_notes(recordings)
    check(start, recordings, parameters)
    with progress("networks", num_fits(recordings, parameters)) as advance:
        found = adapt(start, recordings, wanted.seed, parameters, advance)
    source = f"{data['set']}, from weights {start.hash[:12]}"
    found = intention_network(
        found.weights, {"source": source, "data": data, **found.facts}
    )
    save_weights(out, found)
    _print(found.facts)
    note(
        f"hash {found.hash[:12]}: {out}; it triggers at its own threshold with "
        f"--weights {out}"
    )


def _read(wanted: Adapting, told: Told) -> tuple[list[Recording], dict[str, Any]]:
    """Recordings of a folder, and which state of which data they are.

    Raises:
        ValueError: If the folder is none, or holds no recordings.
    """
    from costeer.training.datasets.catalogue import (
        DATASETS,
        dataset_version,
        files_version,
        read_dataset,
    )
    from costeer.training.recordings import read_recordings

    folder = wanted.folder
    if not folder.is_dir():
        raise ValueError(
            f"--adapt {folder} is no folder; give one that holds recordings of people"
        )
    name = folder.resolve().name
    if name in DATASETS:
        parent = folder.resolve().parent
        data = {"set": name, "version": dataset_version(name, parent)}
        return read_dataset(name, parent), data
    files, way = drives([folder]), way_of(told)
    data = {
        "set": ", ".join(file.name for file in files),
        "version": files_version(files),
    }
    found = read_recordings(files, wanted.resample, way.adaptation, way.reading)
    return found, data


_ROWS = (
    ("pr_auc", "area under precision-recall curve"),
    ("log_loss", "log loss [nat]"),
    ("calibration_error", "calibration error"),
    ("false_triggers", "false triggers"),
    ("false_per_km", "false triggers [1/km]"),
    ("false_per_km_at_most", "at most, 95 % one-sided [1/km]"),
    ("num_crossings", "lane changes"),
    ("missed", "missed"),
    ("lead_time_median", "lead time, median [s]"),
)


def _print(facts: dict[str, Any]) -> None:
    """What was learned from, what was chosen, and what it gives."""
    judged, learned = facts["left_out"], facts["adapted_to"]
    intervals = judged["intervals"]
    note(
        f"learned from {learned['minutes']:.0f} min, {learned['lane_changes']} lane "
        f"changes of {learned['drivers']} driver(s): {facts['steps']} steps, "
        f"temperature {facts['calibration']['temperature']:.2f}, bias "
        f"{facts['calibration']['bias']:+.2f} (few data: no isotonic regression), "
        f"threshold {facts['threshold']:.3f} for "
        f"{facts['false_per_km_allowed']:g} false triggers per km"
    )
    rows = [
        [label, *(_cell(judged[which], name) for which in ("start", "adapted"))]
        for name, label in _ROWS
    ]
    heading = (
        f"Judged on {judged['kind']} left out: {intervals[judged['kind']]}, "
        f"{judged['adapted']['kilometres']:.1f} km"
    )
    print_table(["score", "start", "adapted"], rows, title=heading)
    if "none_because" in intervals:
        note(f"no intervals: {intervals['none_because']}")


def _cell(scores: dict[str, Any], name: str) -> str:
    value, ends = scores[name], scores.get("interval_95", {}).get(name)
    if value is None:
        return "–"
    if name in ("false_triggers", "num_crossings", "missed"):
        return f"{value:.0f}"
    return f"{value:.3f}" + (f" ({ends[0]:.3f} to {ends[1]:.3f})" if ends else "")
