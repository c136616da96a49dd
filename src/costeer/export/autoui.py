"""A study as an artifact that others can run: records, script, `autoui-repro.yml`.

Source: the manifest that reprobe, the harness of the open-data chair of AutomotiveUI,
reads, version 1: `autoui-repro.schema.json` of github.com/M-Colley/reprobe.
"""

from __future__ import annotations

import hashlib
import shutil
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import yaml

from costeer.base.files import write_text
from costeer.study.folder import RECORDS, RESULTS, STUDY_FILE, read_study
from costeer.study.material import find_records
from costeer.study.plain_folder import people_of_records

MANIFEST = "autoui-repro.yml"
SCRIPT = "reproduce.py"
PUBLISHED = "published"
"""Folder of the tables as they were at the export."""
OUTPUTS = (
    "report.html",
    "trials.csv",
    "lane_changes.csv",
    "tests.csv",
    "pairs.csv",
    "summaries.csv",
)
"""What the script writes for every study."""


class Artifact(NamedTuple):
    """What an artifact is made of.

    Attributes:
        title: Of the study.
        version: Of costeer.
        records: Trials, by the name that each gets in `records`.
        tables: Copied into `published`, to compare with what comes out.
        others: Other files and folders of the study that a report is made of.
    """

    title: str
    version: str
    records: Mapping[str, Path]
    tables: Sequence[Path] = ()
    others: Sequence[Path] = ()


def artifact_of_folder(folder: Path, version: str) -> Artifact:
    """A study of virtual drivers, or a plain folder of drive records.

    Args:
        folder: As `costeer study` or `costeer drive` leaves it.
        version: Of costeer.

    Raises:
        ValueError: If it is neither, or a record does not say whose it is.
        OSError: If a file cannot be read.
    """
    tables = sorted(folder.glob("*.csv"))
    if (folder / STUDY_FILE).is_file():
        drivers = read_study(folder).configuration["participants"]
        found = {path.name: path for path in find_records(folder).values()}
        kept = [folder / STUDY_FILE, folder / RESULTS]
        others = [each for each in kept if each.exists()]
        title = f"costeer study, virtual drivers: {drivers}"
        return Artifact(title, version, found, tables, others)
    drives = people_of_records(folder).drives
    people = len({each.participant for each in drives})
    records = {each.record.name: each.record for each in drives}
    return Artifact(f"costeer drives, participants: {people}", version, records, tables)


def write_artifact(artifact: Artifact, out: Path) -> None:
    """Write records, tables, script and manifest into a folder.

    Args:
        artifact: What it is made of.
        out: An empty folder.

    Raises:
        OSError: If a file cannot be read or written.
    """
    for name, source in artifact.records.items():
        _copy(source, out / RECORDS / name)
    for table in artifact.tables:
        _copy(table, out / PUBLISHED / table.name)
    for other in artifact.others:
        _copy(other, out / other.name)
    write_text(out / SCRIPT, _SCRIPT)
    write_text(out / "requirements.txt", f"costeer=={artifact.version}\n")
    readme = _README.format(title=artifact.title, version=artifact.version)
    write_text(out / "README.md", readme)
    told = yaml.safe_dump(manifest(artifact), sort_keys=False, allow_unicode=True)
    write_text(out / MANIFEST, told)


def _copy(source: Path, target: Path) -> None:
    if source.is_dir():
        shutil.copytree(source, target)
        return
    target.parent.mkdir(exist_ok=True)
    shutil.copyfile(source, target)


def manifest(artifact: Artifact) -> dict[str, object]:
    """What `autoui-repro.yml` says: how to run it, what comes out, what it reads."""
    return {
        "version": 1,
        "title": artifact.title,
        "environment": {
            "builder": "pinned-base",
            "type": "python",
            "dependencies": "requirements.txt",
        },
        "data": [
            {"path": f"{RECORDS}/{name}", "checksum": f"sha256:{_sha256(path)}"}
            for name, path in sorted(artifact.records.items())
        ],
        "run": {
            "steps": [
                {
                    "path": SCRIPT,
                    "kind": "python",
                    "expected_outputs": list(OUTPUTS),
                    "description": "tables, tests, figures and report of all records",
                }
            ],
            "network": False,
        },
        "expected_outputs": list(OUTPUTS),
    }


def _sha256(path: Path) -> str:
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


_SCRIPT = '''"""Make tables, tests, figures and report again from the records."""

import sys
from pathlib import Path

from costeer.cli import main

sys.exit(main(["report", str(Path(__file__).resolve().parent)]))
'''

_README = """# {title}

Exported by costeer {version}. To make everything but the records again:

    pip install -r requirements.txt
    python reproduce.py

- `records/`: one trial each, 60 samples per second of every signal, units in the schema
- `reproduce.py` writes `report.html`, the tables and the figures beside this file
- `published/`: the tables as they were at the export, to compare with
- `autoui-repro.yml`: the same for a machine, as the harness of AutomotiveUI reads it

If no package index has this version of costeer, put its wheel beside this file and
write `./costeer-{version}-py3-none-any.whl` into `requirements.txt`.
"""
