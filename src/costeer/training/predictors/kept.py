"""Fits that are done, kept in a folder so that a stop does not lose them."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable, Mapping
from pathlib import Path
from shutil import rmtree
from typing import Any, NamedTuple

import numpy as np

from costeer.base.files import read_whole, write_text
from costeer.intention.predictors.store import (
    KINDS,
    Baseline,
    load_baselines,
    save_baselines,
)
from costeer.training.dataset import Split

MADE_FROM = "made-from.json"


class Kept(NamedTuple):
    """Where fits are kept, and what is there.

    Attributes:
        folder: Of a file for each predictor.
        done: Those that an earlier call finished, by name.
    """

    folder: Path
    done: Mapping[str, Baseline]


def kept_beside(out: Path, made_from: Mapping[str, Any]) -> Kept:  # Any: JSON
    """The fits that are kept for `out`; their folder is made if it is not there.

    Args:
        out: File that all of them are for.
        made_from: All that decides the fits, by the name that a person knows it by.

    Raises:
        ValueError: Naming what differs, if those that are there come from something
            else, or a file is not what it was.
        OSError: If a file cannot be read or written.
    """
    folder = out.with_name(f"{out.name}.parts")
    mark = folder / MADE_FROM
    here = json.loads(json.dumps(dict(made_from)))
    if mark.exists():
        _refuse_others(folder, json.loads(read_whole(mark)), here)
    folder.mkdir(parents=True, exist_ok=True)
    write_text(mark, json.dumps(here, indent=1, ensure_ascii=False) + "\n")
    files = {name: _file(folder, name) for name in KINDS}
    done = {
        name: load_baselines(file)[name]
        for name, file in files.items()
        if file.exists()
    }
    return Kept(folder, done)


def _refuse_others(folder: Path, there: Any, here: Mapping[str, Any]) -> None:
    """Refuse fits of other options, recordings or sources.

    Raises:
        ValueError: Naming what differs.
    """
    known = there if isinstance(there, dict) else {}
    changed = [name for name in here if known.get(name) != here[name]]
    if changed:
        raise ValueError(
            f"{folder} keeps fits of an earlier call that was stopped, with another "
            f"{', '.join(changed)}; give the same to go on, another --out, or remove "
            "that folder to begin again"
        )


def keep(kept: Kept, name: str, fitted: Baseline) -> None:
    """Write one fit, whole or not at all.

    Raises:
        OSError: If it cannot be written.
    """
    save_baselines(_file(kept.folder, name), {name: fitted})


def let_go(kept: Kept) -> None:
    """Remove the folder, once all fits are in their file."""
    rmtree(kept.folder)


def _file(folder: Path, name: str) -> Path:
    return folder / f"{name}.npz"


def recordings_hash(split: Split) -> str:
    """SHA-256 over drivers, names, signals and crossings of all parts of a split."""
    digest = hashlib.sha256()
    for recordings in split:
        digest.update(f"{len(recordings)} recordings".encode())
        for one in recordings:
            _update(digest, (one.features, one.side, one.crossing, one.intended))
            digest.update(json.dumps([one.driver, one.name, one.absent]).encode())
    return digest.hexdigest()


def _update(digest: Any, arrays: Iterable[Any]) -> None:  # Any: of hashlib, of NumPy
    for values in arrays:
        digest.update(f"{values.shape} {values.dtype.str}".encode())
        digest.update(np.ascontiguousarray(values).tobytes())
