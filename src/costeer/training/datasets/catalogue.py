"""Which sets of real driving can be read, by name."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TypeAlias

from costeer.training.datasets import (
    brain4cars_head,
    ngsim_commonroad,
    ngsim_i80_following,
    ngsim_lc,
    r3_driving,
)
from costeer.training.datasets.tables import stored
from costeer.training.recordings import Recording

Loader: TypeAlias = Callable[[Path], list[Recording]]
"""From the folder of a set to its recordings."""

DATASETS: Mapping[str, Loader] = {
    "ngsim_lc": ngsim_lc.read,
    "ngsim_commonroad": ngsim_commonroad.read,
    "r3_driving": r3_driving.read,
    "brain4cars_head": brain4cars_head.read,
    "ngsim_i80_following": ngsim_i80_following.read,
}
"""Loader of each set, in the order in which they are told."""

FILES: Mapping[str, tuple[str, ...]] = {
    "ngsim_lc": ngsim_lc.FILES,
    "ngsim_commonroad": ngsim_commonroad.FILES,
    "r3_driving": r3_driving.FILES,
    "brain4cars_head": brain4cars_head.FILES,
    "ngsim_i80_following": ngsim_i80_following.FILES,
}
"""What must be in the folder of each set; `.gz` files may be unpacked."""


def files_version(paths: Sequence[Path]) -> str:
    """What tells one state of some files from another, by the bytes of all.

    Raises:
        OSError: If one cannot be read.
    """
    digest = hashlib.sha256()
    for path in paths:
        with path.open("rb") as file:
            digest.update(hashlib.file_digest(file, "sha256").digest())
    return f"sha256:{digest.hexdigest()[:16]}"


def dataset_version(name: str, folder: Path) -> str:
    """Of the files of a set, as they are in `folder`.

    Raises:
        OSError: If one cannot be read.
    """
    there = [stored(folder / name / file) for file in FILES[name]]
    return files_version([each for each in there if each is not None])


def read_dataset(name: str, folder: Path) -> list[Recording]:
    """Recordings of one set, read in place.

    Args:
        name: Of the set, as in `DATASETS`.
        folder: That holds one subfolder for each set, of its name.

    Raises:
        ValueError: If there is no such set, its folder or a file is missing, or a file
            cannot be understood.
    """
    if name not in DATASETS:
        raise ValueError(
            f"there is no set '{name}'; choose {', '.join(DATASETS)}, or write a "
            "loader of your own (docs/datasets.md)"
        )
    if not folder.is_dir():
        raise ValueError(
            f"'{folder}' is no folder; name the one that holds {name} "
            f"({', '.join(FILES[name])})"
        )
    missing = [file for file in FILES[name] if stored(folder / name / file) is None]
    if missing:
        raise ValueError(
            f"'{folder}' has no {', '.join(f'{name}/{file}' for file in missing)}; "
            f"name the folder that holds {name}, with the file packed or not"
        )
    return DATASETS[name](folder / name)
