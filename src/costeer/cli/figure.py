"""`costeer report --figure`: one figure of a study as a file for a journal."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from costeer.study.people import People


class Wanted(NamedTuple):
    """A figure as it was asked for.

    Attributes:
        name: Of the figure; None if the whole report is wanted.
        width: Of the figure [mm]; None for its own.
        kind: Format; None if the ending of `out` tells it.
        out: File; None for the folder of figures.
    """

    name: str | None
    width: float | None
    kind: str | None
    out: Path | None


def checked(wanted: Wanted) -> Wanted:
    """The same with a format, refused before anything is read.

    Raises:
        ValueError: If options contradict each other, or a value is out of range.
    """
    from costeer.pages.publish import FORMATS, NARROWEST_MM, WIDEST_MM

    if wanted.name is None:
        options = ("--width", "--format", "--out")
        for option, value in zip(options, wanted[1:], strict=True):
            if value is not None:
                raise ValueError(f"{option} belongs to --figure; name a figure")
        return wanted
    width, ending = wanted.width, "" if wanted.out is None else wanted.out.suffix[1:]
    kind = (wanted.kind or ending or "pdf").lower()
    if kind not in FORMATS:
        raise ValueError(
            f"there is no format {kind!r} of a figure; choose from {', '.join(FORMATS)}"
        )
    if ending and ending.lower() != kind:
        raise ValueError(f"--out ends in .{ending} and --format is {kind}; choose one")
    if width is not None and not NARROWEST_MM <= width <= WIDEST_MM:
        told = f"{width:g} mm" if math.isfinite(width) else "no number"
        raise ValueError(
            f"--width is {told}; give {NARROWEST_MM:g} to {WIDEST_MM:g} mm, as 88mm"
        )
    if kind == "csv" and width is not None:
        raise ValueError("the data of a figure have no width; leave --width out")
    return wanted._replace(kind=kind)


def write_figure(
    folder: Path, wanted: Wanted, people: People | None, beside: Path | None
) -> Path:
    """Draw one figure from the tables of a study and write it.

    Args:
        folder: Of the study.
        wanted: Checked, with a name.
        people: Whose drives these are; None for a folder with `study.yaml`.
        beside: Folder of virtual drivers to compare with.

    Raises:
        ValueError: If the figure is not known, not drawn, or not legible so narrow.
        OSError: If a file cannot be read or written.
    """
    from costeer.base.files import replacing
    from costeer.pages.publish import published
    from costeer.study.report import FIGURES, one_figure

    name, kind = str(wanted.name), str(wanted.kind)
    with one_figure(folder, name, people, beside) as exhibit:
        content = published(exhibit, wanted.width, kind)
    file = wanted.out or folder / FIGURES / f"{name}.{kind}"
    if wanted.out is None:
        file.parent.mkdir(exist_ok=True)
    with replacing(file) as partial:
        partial.write_bytes(content)
    return file
