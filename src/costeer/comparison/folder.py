"""The folder of a comparison: what it says it is, and the results of each block.

`compare.yaml` binds it to one configuration. The results of a block of drivers are one
small file that is there whole or not at all; only those of this configuration count.
"""

from __future__ import annotations

import hashlib
import json
import math
import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import yaml

from costeer.base.files import read_whole, write_text
from costeer.base.nested import read_mapping
from costeer.comparison.configuration import differences
from costeer.comparison.design import Block, Cell
from costeer.comparison.measures import COLUMNS, Moment, TrialOutcome
from costeer.scale.shard import WHOLE, Shard
from costeer.study.folder import configuration_hash
from costeer.study.locks import held_folder

COMPARE_FILE = "compare.yaml"
RESULTS = "results"
RECORDS = "records"
FORMAT = 1

_NOT_IN_NAMES = re.compile(r"[^A-Za-z0-9.]+")


class ComparisonFolder(NamedTuple):
    """A folder that belongs to one configuration.

    Attributes:
        path: The folder.
        configuration: All that determines the results.
        hash: Of the configuration.
    """

    path: Path
    configuration: dict[str, Any]  # Any: values of YAML
    hash: str


@contextmanager
def opened_comparison(
    path: Path, configuration: dict[str, Any], text: str, shard: Shard = WHOLE
) -> Iterator[ComparisonFolder]:
    """Hold the folder, or a shard of it, for this configuration, new or begun before.

    Args:
        path: Made if it is not there.
        configuration: All that determines the results.
        text: Of `compare.yaml`.
        shard: To hold; others may work on the other shards meanwhile.

    Raises:
        ValueError: If it is another comparison's, holds other things, or another
            process works in it.
        OSError: If it cannot be written.
    """
    folder = ComparisonFolder(path, configuration, configuration_hash(configuration))
    begin = partial(_begin, folder, text)
    with held_folder(path, COMPARE_FILE, "comparison", shard, begin):
        yield folder


def _begin(folder: ComparisonFolder, text: str, alone: bool) -> None:
    """Write what the comparison is, or see that the folder is the same one's."""
    path = folder.path
    if (path / COMPARE_FILE).exists():
        refuse_other(read_comparison(path), folder)
    else:
        write_text(path / COMPARE_FILE, text)
    (path / RESULTS).mkdir(exist_ok=True)
    if alone:
        for leftover in path.rglob("*.tmp"):
            leftover.unlink(missing_ok=True)


def refuse_other(there: ComparisonFolder, wanted: ComparisonFolder) -> None:
    """Refuse a folder that holds another comparison than the wanted one.

    Raises:
        ValueError: Saying in what they differ.
    """
    if there.hash != wanted.hash:
        told = differences(there.configuration, wanted.configuration)
        raise ValueError(
            f"{there.path} holds another comparison: {told}. Choose another folder, "
            "or give the options, files and version of that one to resume it"
        )


def comparison_text(configuration: dict[str, Any], command: str) -> str:
    """What `compare.yaml` holds: the command as a comment, then all that decides."""
    content = {
        "format": FORMAT,
        "configuration_hash": configuration_hash(configuration),
        "configuration": configuration,
    }
    body = yaml.safe_dump(content, sort_keys=False, allow_unicode=True, width=88)
    return f"# A comparison. Run it again, or finish it, with\n#   {command}\n{body}"


def read_comparison(path: Path) -> ComparisonFolder:
    """What `compare.yaml` in the folder says.

    Raises:
        ValueError: If it is missing, unreadable or was edited.
        OSError: If it cannot be read.
    """
    file = path / COMPARE_FILE
    if not file.is_file():
        raise ValueError(f"{path} is no comparison: it has no {COMPARE_FILE}")
    content = read_mapping(file)
    configuration = content.get("configuration")
    if content.get("format") != FORMAT or not isinstance(configuration, dict):
        raise ValueError(f"{file} is not of format {FORMAT}; {_RESTORE}")
    found = json.loads(json.dumps(configuration))
    if content.get("configuration_hash") != configuration_hash(found):
        raise ValueError(f"{file} was edited: its hash does not fit; {_RESTORE}")
    return ComparisonFolder(path, found, str(content["configuration_hash"]))


_RESTORE = "restore it, or choose another folder"


def cell_name(cell: Cell) -> str:
    """Name of a cell in names of files."""
    parts = (cell.entrant.name, cell.course.name, cell.mistake)
    words = [_NOT_IN_NAMES.sub("_", part) for part in parts]
    return f"{cell.number:04d}-{'-'.join(words)}"


def block_path(folder: Path, block: Block) -> Path:
    """Where the results of a block lie."""
    return (
        folder / RESULTS / f"{cell_name(block.cell)}-{block.participants[0]:05d}.json"
    )


def record_path(folder: Path, cell: Cell, participant: int) -> Path:
    """Where the record of a trial lies, if records are kept."""
    return folder / RECORDS / cell_name(cell) / f"{participant:05d}.parquet"


def write_block(
    folder: ComparisonFolder, block: Block, outcomes: Sequence[TrialOutcome]
) -> None:
    """Write the results of a block, whole or not at all.

    Raises:
        OSError: If they cannot be written.
    """
    content = {
        "comparison": folder.hash,
        "cell": cell_name(block.cell),
        "columns": list(COLUMNS),
        "trials": [_plain(each) for each in outcomes],
    }
    told = {"sha256": _digest(content), "results": content}
    text = json.dumps(told, allow_nan=False, separators=(",", ":"))
    write_text(block_path(folder.path, block), text + "\n")


def _digest(content: Any) -> str:  # Any: of JSON
    text = json.dumps(content, allow_nan=False, separators=(",", ":"))
    return hashlib.sha256(text.encode()).hexdigest()


def read_block(folder: ComparisonFolder, block: Block) -> list[TrialOutcome] | None:
    """The results of a block; None if there are none that can be believed.

    Raises:
        OSError: If its file is there and cannot be read.
    """
    try:
        told = json.loads(read_whole(block_path(folder.path, block)))
        content = told["results"]
        if told["sha256"] != _digest(content):
            return None
        said = content["comparison"], content["cell"], content["columns"]
        outcomes = [
            TrialOutcome(
                participant=int(each["participant"]),
                failure=str(each["failure"]),
                torque_faults=int(each["torque_faults"]),
                values=tuple(_read(value) for value in each["values"]),
                disputes=_moments(each["disputes"]),
            )
            for each in content["trials"]
        ]
    except (FileNotFoundError, ValueError, KeyError, TypeError):
        return None
    except (OverflowError, RecursionError):  # what damage can make of numbers and lists
        return None
    wanted = folder.hash, cell_name(block.cell), list(COLUMNS)
    who = tuple(each.participant for each in outcomes)
    whole = all(len(each.values) == len(COLUMNS) for each in outcomes)
    return outcomes if said == wanted and who == block.participants and whole else None


def _plain(outcome: TrialOutcome) -> dict[str, Any]:  # Any: of JSON
    moments = outcome.disputes
    return outcome._asdict() | {
        "values": list(map(_written, outcome.values)),
        "disputes": None
        if moments is None
        else [list(map(_written, each)) for each in moments],
    }


def _moments(told: Any) -> tuple[Moment, ...] | None:  # Any: of JSON
    if told is None:
        return None
    return tuple(Moment(*(_read(value) for value in each)) for each in told)


def _written(value: float) -> float | str | None:
    """A number as JSON has it: NaN is null, the infinite a word."""
    if math.isnan(value):
        return None
    return value if math.isfinite(value) else str(value)


def _read(value: float | str | None) -> float:
    return math.nan if value is None else float(value)
