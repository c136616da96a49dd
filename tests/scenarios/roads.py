"""Small OpenDRIVE files, written as the standard says."""

from __future__ import annotations

from pathlib import Path

LINE = '<geometry s="{s}" x="{x}" y="0" hdg="0" length="{length}"><line/></geometry>'


def lane(number: int, width: float = 3.5, kind: str = "driving", more: str = "") -> str:
    """A lane of constant width."""
    return (
        f'<lane id="{number}" type="{kind}">{more}'
        f'<width sOffset="0" a="{width}" b="0" c="0" d="0"/></lane>'
    )


def section(left: str = "", right: str = "", s: float = 0.0) -> str:
    """A lane section."""
    centre = '<center><lane id="0" type="none"/></center>'
    return (
        f'<laneSection s="{s}"><left>{left}</left>{centre}'
        f"<right>{right}</right></laneSection>"
    )


TWO = section(right=lane(-1) + lane(-2))


def road(plan: str, lanes: str = TWO, more: str = "", inside: str = "") -> str:
    """A road; each part begins on a line of its own."""
    return (
        f'<road id="1" length="500" junction="-1" {more}>\n<planView>\n{plan}\n'
        f"</planView>\n{inside}<lanes>\n{lanes}\n</lanes>\n</road>\n"
    )


def straight(length: float = 500.0) -> str:
    """A plan of one line."""
    return LINE.format(s=0, x=0, length=length)


def write(folder: Path, *roads: str) -> Path:
    """A file with roads."""
    file = folder / "road.xodr"
    text = '<?xml version="1.0"?>\n<OpenDRIVE>\n<header revMajor="1" revMinor="7"/>\n'
    file.write_text(f"{text}{''.join(roads)}</OpenDRIVE>\n", encoding="utf-8")
    return file
