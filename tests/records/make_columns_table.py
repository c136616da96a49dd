"""Write the table of docs/records.md: `python -m tests.records.make_columns_table`.

It is made of `COLUMNS`, so that a new column is declared in one place.
"""

from __future__ import annotations

import re
from pathlib import Path

from costeer.records.columns import COLUMNS, Column

PAGE = Path(__file__).parents[2] / "docs" / "records.md"
TABLE = re.compile(r"(?<=\n\n)\| column \|.*?(?=\n\n)", re.DOTALL)


def columns_table() -> str:
    """The table of all columns in the order of the file, as Markdown."""
    rows = [
        ("column", "unit", "type", "what it is", "in manual", "in a mirror"),
        ("---",) * 6,
        *(_row(column) for column in COLUMNS),
    ]
    return "\n".join(f"| {' | '.join(row)} |" for row in rows)


def _row(column: Column) -> tuple[str, ...]:
    empty = column.labels[0] if column.labels else "NaN"
    if column.nullable:
        empty = "null"
    return (
        f"`{column.name}`",
        column.unit,
        column.kind,
        column.description,
        empty if column.assisted_only else "",
        "" if column.mirrored == "same" else column.mirrored,
    )


if __name__ == "__main__":
    page = TABLE.sub(lambda _: columns_table(), PAGE.read_text("utf-8"))
    PAGE.write_text(page, "utf-8")
