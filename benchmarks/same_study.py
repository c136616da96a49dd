"""Whether a study came out the same with other code, and by how much it did not.

Run: `python -m benchmarks.same_study FOLDER OTHER`

Both folders hold the same study (`costeer study`), driven by two versions of costeer.
Prints for each kind of column how many differ in anything but digits (length, words,
whole numbers, flags, missing values), the largest differences of signals as a share of
the largest value, and those of the tables. Exit code 1 if a verdict, mode, lane, event
or missing value is another.
"""

from __future__ import annotations

import csv
import sys
from pathlib import Path
from typing import NamedTuple

import numpy as np

from costeer.records.record import TrialRecord, read_record

TABLES = ("trials", "lane_changes", "triggers", "tests", "pairs")
SHOWN = 5


class Differences(NamedTuple):
    """How two records differ.

    Attributes:
        discrete: Columns that differ in more than digits.
        shares: Largest difference of each signal by its largest value [-].
    """

    discrete: list[str]
    shares: dict[str, float]


def differences(one: TrialRecord, other: TrialRecord) -> Differences:
    """Compare two records, column by column."""
    found = Differences([], {})
    for name, values in one.columns.items():
        others = other.columns[name]
        if len(values) != len(others):
            return Differences([*found.discrete, f"{name} (length)"], found.shares)
        if values.dtype.kind != "f":
            missing = np.array_equal(*map(np.ma.getmaskarray, (values, others)))
            if not missing or not np.ma.allequal(values, others):
                found.discrete.append(name)
            continue
        known = ~np.isnan(values)
        if not np.array_equal(known, ~np.isnan(others)):
            found.discrete.append(name)
        elif known.any():
            size = float(np.abs(values[known]).max()) or 1.0
            found.shares[name] = float(np.abs(values - others)[known].max()) / size
    return found


def largest_of_table(one: Path, other: Path) -> float:
    """Largest difference of numbers of two tables by their size; infinite for words."""
    texts = (file.read_text("utf-8") for file in (one, other))
    rows = [list(csv.reader(text.splitlines())) for text in texts]
    if list(map(len, rows[0])) != list(map(len, rows[1])):
        return float("inf")
    largest = 0.0
    for left, right in zip(*rows, strict=True):
        for a, b in zip(left, right, strict=True):
            if a != b:
                try:
                    largest = max(largest, abs(float(a) / float(b) - 1.0))
                except (ValueError, ZeroDivisionError):
                    return float("inf")
    return largest


def main(words: list[str]) -> int:
    """Print the differences."""
    if len(words) != 2:
        print(__doc__)
        return 2
    one, other = map(Path, words)
    shares: dict[str, float] = {}
    changed = 0
    files = sorted((one / "records").glob("*.parquet"))
    for file in files:
        twin = other / "records" / file.name
        found = differences(read_record(file), read_record(twin))
        changed += bool(found.discrete)
        if found.discrete:
            print(f"{file.name}: {', '.join(found.discrete)}")
        for name, share in found.shares.items():
            shares[name] = max(shares.get(name, 0.0), share)
    print(f"{len(files)} records, {changed} differ in more than digits")
    for name in sorted(shares, key=lambda each: -shares[each])[:SHOWN]:
        print(f"{name}: {shares[name]:.1e} of its largest value")
    for table in TABLES:
        path = f"{table}.csv"
        print(f"{path}: {largest_of_table(one / path, other / path):.1e}")
    return int(changed > 0)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
