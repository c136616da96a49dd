"""Results of shards put together: every piece once, none missing, none in two kinds."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple, TypeVar

from costeer.base.files import replacing

Piece = TypeVar("Piece")

_NAMED = 3
"""Pieces that a message names before it counts the others."""


class Found(NamedTuple):
    """The result of a piece in a folder.

    Attributes:
        file: That holds it.
        failed: Whether it is a failure.
    """

    file: Path
    failed: bool = False


def gathered(
    pieces: Sequence[Piece],
    places: Callable[[Piece], Sequence[Found]],
    told: Callable[[Piece], str],
    what: str,
) -> tuple[dict[Piece, Found], list[Piece]]:
    """Where each piece is taken from, and those that several folders have.

    Args:
        pieces: All that there must be.
        places: The results of a piece, in the order of the folders.
        told: A piece in words.
        what: Pieces are called.

    Raises:
        ValueError: If one is missing, or has different results in two folders.
    """
    chosen: dict[Piece, Found] = {}
    repeated, missing = [], []
    for piece in pieces:
        there = places(piece)
        if not there:
            missing.append(piece)
            continue
        done = [each for each in there if not each.failed]
        for other in done[1:]:
            if other.file.read_bytes() != done[0].file.read_bytes():
                raise ValueError(different(told(piece), done[0].file, other.file))
        if len(done) > 1:
            repeated.append(piece)
        chosen[piece] = (done or there)[0]
    refuse_missing([told(each) for each in missing], len(pieces), what)
    return chosen, repeated


def different(piece: str, one: Path, other: Path) -> str:
    """What is said of a piece with different results in two places."""
    return (
        f"{piece} has different results in {one} and {other}, as of different "
        "machines; remove one of them, or run all shards on machines of one kind"
    )


def refuse_missing(missing: Sequence[str], total: int, what: str) -> None:
    """Refuse a whole that lacks something.

    Args:
        missing: In words.
        total: Of all that there must be.
        what: They are called.

    Raises:
        ValueError: Naming the first of them.
    """
    if not missing:
        return
    more = len(missing) - _NAMED
    raise ValueError(
        f"{len(missing)} of {total} {what} are missing: {', '.join(missing[:_NAMED])}"
        f"{f' and {more} more' if more > 0 else ''}; run their shards again, then "
        "merge"
    )


def copied(files: Mapping[Path, Path]) -> None:
    """Copy files, each whole or not at all.

    Args:
        files: From where, by where to.

    Raises:
        OSError: If one cannot be read or written.
    """
    for target, source in files.items():
        if target.exists() and target.samefile(source):
            continue
        target.parent.mkdir(parents=True, exist_ok=True)
        with replacing(target) as partial:
            shutil.copyfile(source, partial)
