"""A figure with its words: title, caption, and a text for those who do not see it."""

from __future__ import annotations

from typing import NamedTuple

from matplotlib.figure import Figure

from costeer.pages.series import Other


class Exhibit(NamedTuple):
    """One figure of the report.

    Attributes:
        name: Stem of its file.
        title: In a few words.
        caption: What is shown, of whom, with which intervals.
        description: What one would tell somebody who does not see it.
        figure: The drawing; None if the study has not what it needs.
        missing: What it lacks, as a sentence; empty if it is drawn.
        others: The same of other participants, to choose from on the page.
    """

    name: str
    title: str
    caption: str
    description: str
    figure: Figure | None
    missing: str = ""
    others: tuple[Other, ...] = ()


def not_drawn(name: str, title: str, missing: str) -> Exhibit:
    """Return a figure that the study has not the data for."""
    return Exhibit(name, title, "", "", None, missing)
