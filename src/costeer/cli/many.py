"""`costeer analyse FOLDER --out table.csv`: every drive of a folder, a row for each."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from costeer.study.analysis import Analysis

_ENDINGS = (".csv", ".txt", ".dat", ".tsv", ".parquet", ".arrow", ".feather", ".gz")

_FROM_OUTSIDE = ("file", "sequence", "notes", "error")
"""Columns of a table that hold what others have written."""


def drives(paths: Sequence[Path]) -> list[Path]:
    """The files, and the tables in folders among them, in order of name.

    Raises:
        ValueError: If a folder holds none.
    """
    found = []
    for path in paths:
        if not path.is_dir():
            found.append(path)
            continue
        inside = [p for p in sorted(path.iterdir()) if p.suffix.lower() in _ENDINGS]
        if not inside:
            raise ValueError(
                f"{path} holds no table; their names end in {', '.join(_ENDINGS)}"
            )
        found += inside
    return found


def analysed(
    files: Sequence[Path], one: Callable[[Path], list[Analysis]]
) -> tuple[list[Analysis], dict[str, str]]:
    """Measures of each file, and why there are none of those that cannot be read."""
    found: list[Analysis] = []
    refused: dict[str, str] = {}
    for file in files:
        try:
            found += one(file)
        except (ValueError, OSError) as error:
            refused[str(file)] = " ".join(str(error).split())
    return found, refused


def write_rows(out: Path, found: Sequence[Analysis], refused: dict[str, str]) -> None:
    """Write a table with a row for each drive, and for each file that was refused.

    Raises:
        OSError: If it cannot be written.
    """
    import pandas as pd

    from costeer.base.files import write_text
    from costeer.study.trial_tables import without_formula

    rows: list[dict[str, object]] = [
        {
            "file": each.source,
            "sequence": each.sequence,
            "num_rows": each.num_rows,
            "rate": each.sampling.rate,
            **{name: measure.value for name, measure in each.measures.items()},
            "notes": "; ".join(each.notes),
            "error": "",
        }
        for each in found
    ]
    rows += [{"file": file, "error": why} for file, why in refused.items()]
    table = pd.DataFrame(rows)
    for name in table.columns.intersection(_FROM_OUTSIDE):
        table[name] = table[name].map(without_formula, na_action="ignore")
    write_text(out, table.to_csv(index=False))
