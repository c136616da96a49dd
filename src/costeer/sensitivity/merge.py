"""Shards of a sensitivity analysis put together: every sample once."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from costeer.base.files import read_whole
from costeer.scale.gathered import Found, copied, gathered
from costeer.sensitivity.run import (
    SETTINGS_FILE,
    Outcome,
    Settings,
    check_settings,
    outcome_file,
    points,
    prepare,
    read_outcome,
)


class Merged(NamedTuple):
    """What a merge found.

    Attributes:
        folder: Of the whole analysis.
        settings: Of the analysis.
        outcomes: Of all samples, in order.
        repeated: Samples that several folders had, with the same bytes, in words.
    """

    folder: Path
    settings: Settings
    outcomes: list[Outcome]
    repeated: tuple[str, ...]


def merge_sensitivity(
    folders: Sequence[Path | str], out: Path | str | None = None
) -> Merged:
    """Put the samples of all shards into one folder.

    Args:
        folders: The folder that the shards shared, or those of all of them.
        out: Where the analysis is put together; needed for several folders.

    Raises:
        ValueError: If samples are missing, a folder is of another analysis or of other
            sources, or two have the same sample with different results.
        OSError: If a file cannot be read or written.
    """
    there = [Path(each) for each in folders]
    if not there:
        raise ValueError("there is nothing to merge: give the folders of the shards")
    if out is None and len(there) > 1:
        raise ValueError(
            f"{len(there)} folders need one to be put together in; give --out DIR"
        )
    settings = settings_in(there[0])
    keys = [prepare(each, settings) for each in there]  # refuses other analyses
    places = range(len(points(settings)))

    def found(place: int) -> list[Found]:
        return [
            Found(outcome_file(each, place))
            for each, key in zip(there, keys, strict=True)
            if read_outcome(each, key, place) is not None
        ]

    chosen, repeated = gathered(places, found, _told, "samples")
    home = there[0] if out is None else Path(out)
    key = prepare(home, settings)
    copied({outcome_file(home, place): one.file for place, one in chosen.items()})
    outcomes = [read_outcome(home, key, place) for place in places]
    return Merged(
        folder=home,
        settings=settings,
        outcomes=[each for each in outcomes if each is not None],
        repeated=tuple(map(_told, repeated)),
    )


def _told(place: int) -> str:
    """A sample in words."""
    return f"sample {place + 1}"


def settings_in(folder: Path) -> Settings:
    """The settings of the analysis in a folder.

    Raises:
        ValueError: If it is none, or they cannot be.
        OSError: If they cannot be read.
    """
    file = folder / SETTINGS_FILE
    if not file.is_file():
        raise ValueError(f"{folder} is no sensitivity analysis: no {SETTINGS_FILE}")
    try:
        told = json.loads(read_whole(file))["settings"]
        return check_settings(Settings(**told))
    except (ValueError, KeyError, TypeError) as error:
        raise ValueError(f"{file} cannot be used: {error}") from error
