"""The study's folder: who may write in it, and what it says it is.

`study.yaml` holds all that is needed to run the study again. A folder belongs to one
configuration.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import yaml

from costeer.base.files import read_whole, write_text
from costeer.scale.shard import WHOLE, Shard
from costeer.study.changes import refusal
from costeer.study.kinds import wrong_kind
from costeer.study.locks import held_folder

STUDY_FILE = "study.yaml"
RECORDS = "records"
RESULTS = "results"
_LARGEST = 1_000_000
"""Values of a configuration; no study has a hundredth of it."""

FORMAT = 1
"""Of the folder; a later one that old code cannot read gets a higher number."""


class StudyFolder(NamedTuple):
    """A folder that belongs to one configuration.

    Attributes:
        path: The folder.
        configuration: All that determines the results.
        hash: Of the configuration.
    """

    path: Path
    configuration: dict[str, Any]  # as YAML gives it back
    hash: str


def configuration_hash(configuration: dict[str, Any]) -> str:
    """Return the SHA-256 of the configuration's canonical JSON, in hexadecimal."""
    canonical = json.dumps(
        configuration, sort_keys=True, separators=(",", ":"), allow_nan=False
    )
    return hashlib.sha256(canonical.encode()).hexdigest()


def record_path(folder: Path, participant: int, condition: str) -> Path:
    """Return where the trial's record lies: `records/03-strong-rapid.parquet`."""
    return folder / RECORDS / f"{participant:02d}-{condition}.parquet"


def result_path(folder: Path, participant: int, condition: str) -> Path:
    """Return where the measures of a trial without a record lie."""
    return folder / RESULTS / f"{participant:02d}-{condition}.json"


def read_study(path: Path) -> StudyFolder:
    """Return what `study.yaml` in the folder says.

    Raises:
        ValueError: If it is missing, unreadable or was edited, or a setting is of a
            kind that it cannot be.
    """
    file = path / STUDY_FILE
    if not file.is_file():
        raise ValueError(f"{path} is not a study folder: it has no {STUDY_FILE}")
    content = _yaml_mapping(file)
    configuration = content.get("configuration")
    if not isinstance(configuration, dict) or content.get("format") != FORMAT:
        raise ValueError(unusable(file, f"it is not of format {FORMAT}"))
    try:
        found = configuration_hash(configuration)
    except (TypeError, ValueError, RecursionError) as error:
        why = "its configuration holds what no study has"
        raise ValueError(unusable(file, why)) from error
    if content.get("configuration_hash") != found:
        raise ValueError(unusable(file, "its hash does not fit its configuration"))
    wrong = wrong_kind(configuration)
    if wrong:
        raise ValueError(unusable(file, wrong))
    return StudyFolder(path, configuration, str(content["configuration_hash"]))


def _yaml_mapping(file: Path) -> dict[str, Any]:
    text = read_whole(file)
    try:
        size = _size(yaml.compose(text, yaml.SafeLoader), {})
        content = yaml.safe_load(text) if size <= _LARGEST else None
    except Exception as error:  # whatever damage makes the parser raise
        where = getattr(error, "problem_mark", None)
        place = f", line {where.line + 1}" if where else ""
        raise ValueError(unusable(file, f"it is not YAML{place}")) from error
    if size > _LARGEST:
        raise ValueError(unusable(file, "its references to itself grow too large"))
    if not isinstance(content, dict):
        raise ValueError(unusable(file, "it is not YAML of a study"))
    return content


# Any: nodes of the parser, which has no types for them.
def _size(node: Any, known: dict[int, int]) -> int:
    """Number of values once every reference is written out."""
    if node is None or isinstance(node, yaml.ScalarNode):
        return 1
    if id(node) not in known:
        known[id(node)] = _LARGEST + 1  # of one that holds itself
        parts = [part for each in node.value for part in _parts(each)]
        known[id(node)] = 1 + sum(_size(part, known) for part in parts)
    return known[id(node)]


def _parts(value: Any) -> tuple[Any, ...]:
    """The nodes of an entry: key and value of a mapping, or the item of a list."""
    return value if isinstance(value, tuple) else (value,)


def unusable(file: Path, why: str) -> str:
    """Say that a file of a study cannot be used, and the way out."""
    return f"{file} cannot be used: {why}; restore it, or choose another folder"


@contextmanager
def opened_study(
    path: Path,
    configuration: dict[str, object],
    command: str,
    shard: Shard = WHOLE,
) -> Iterator[StudyFolder]:
    """Hold the folder, or a shard of it, for this configuration, new or begun before.

    Args:
        path: Made if it is not there.
        configuration: All that determines the results.
        command: That runs the study again; a comment in `study.yaml`.
        shard: To hold; others may work on the other shards meanwhile.

    Raises:
        ValueError: If the folder is another study's, holds other things, or another
            process works in it.
        OSError: If it cannot be written.
    """
    folder = StudyFolder(path, dict(configuration), configuration_hash(configuration))
    begin = partial(_begin, folder, command)
    with held_folder(path, STUDY_FILE, "study", shard, begin):
        yield folder


def _begin(folder: StudyFolder, command: str, alone: bool) -> None:
    """Write what the study is, or see that the folder is the same study's."""
    path = folder.path
    if (path / STUDY_FILE).exists():
        _refuse_other(folder, read_study(path))
    else:
        write_text(path / STUDY_FILE, _study_text(folder, command))
    if alone:
        remove_leftovers(path)
    (path / RECORDS).mkdir(exist_ok=True)


def _refuse_other(wanted: StudyFolder, found: StudyFolder) -> None:
    if wanted.hash == found.hash:
        return
    told = refusal(found.configuration, wanted.configuration)
    raise ValueError(f"{wanted.path} holds {told}")


def _study_text(folder: StudyFolder, command: str) -> str:
    content = {
        "format": FORMAT,
        "configuration_hash": folder.hash,
        "configuration": folder.configuration,
    }
    body = yaml.safe_dump(content, sort_keys=False, allow_unicode=True, width=88)
    return f"# A costeer study. Run it again, or finish it, with\n#   {command}\n{body}"


def remove_leftovers(path: Path) -> None:
    """Remove what a killed process or worker had half written."""
    for folder in (path, path / RECORDS, path / RESULTS, path / "figures"):
        for leftover in folder.glob("*.tmp"):
            leftover.unlink(missing_ok=True)
