"""`costeer export`: a record for other programs, a study for other people."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from costeer.cli.console import note_all

if TYPE_CHECKING:
    from costeer.records.record import TrialRecord

FORMATS = {"mcap": ".mcap", "parquet": ".parquet"}
"""What a record can be written as, and how such a file's name ends."""


def export(
    file: Annotated[
        Path,
        typer.Argument(
            help="Trial record, table, stream of an interrupted drive, or study folder."
        ),
    ],
    out: Annotated[Path, typer.Option(help="File to write; for a study, the folder.")],
    to: Annotated[
        str, typer.Option(help="Format to write: mcap or parquet; for a study, autoui.")
    ] = "mcap",
) -> None:
    """Write a record for other programs, or a study for other people.

    MCAP with Protobuf messages opens in Foxglove, PlotJuggler and rerun. Parquet turns
    the stream of an interrupted drive into a trial record, and a stream whose name ends
    in .wheel.arrow into the table of the wheel. With autoui, a folder of a study or of
    drive records becomes a folder to share: records, tables, a script that makes the
    report again, and autoui-repro.yml, which describes them.

    Example:
        costeer export out/trial.parquet --to mcap --out out/trial.mcap
        costeer export out/drive.arrow --to parquet --out out/saved.parquet
        costeer export out/study --to autoui --out shared
    """
    if to == "autoui":
        _share(file, out)
        return
    _check_target(file, out, to)
    if file.name.endswith(".wheel.arrow"):
        _save_trace(file, out, to)
        return
    from costeer.records.record import read_noted

    record, told = read_noted(file)
    note_all(file, told)
    out.parent.mkdir(parents=True, exist_ok=True)
    try:
        _write(record, out, to)
    except ValueError as error:
        raise ValueError(f"{file}: {error}") from error
    typer.echo(out)


def _share(folder: Path, out: Path) -> None:
    """Write a study as an artifact that others can run.

    Raises:
        ValueError: If it is no folder of a study, or `out` is not empty.
        OSError: If a file cannot be read or written.
    """
    from importlib.metadata import version

    from costeer.base.files import prepare_folder
    from costeer.export.autoui import artifact_of_folder, write_artifact
    from costeer.sessions.store import STORE_FILE

    if (folder / STORE_FILE).is_file():
        raise ValueError(
            f"{folder} is a session; run: costeer session export {folder} "
            f"--format autoui --out {out}"
        )
    if out.is_dir() and any(out.iterdir()):
        raise ValueError(f"--out is {out}, which is not empty; give a new folder")
    if folder.resolve() in (out.resolve(), *out.resolve().parents):
        raise ValueError(f"--out is {out}, within the study; give a folder outside")
    artifact = artifact_of_folder(folder, version("costeer"))
    prepare_folder(out, ".export", "export")
    write_artifact(artifact, out)
    typer.echo(out)


def _save_trace(file: Path, out: Path, to: str) -> None:
    """Make Parquet of what a drive left of the wheel's trace.

    Raises:
        ValueError: If another format is asked for, or there is no row in it.
    """
    from costeer.runtime.stream import save_trace

    if to != "parquet":
        raise ValueError(f"--to is {to}; the wheel's trace becomes parquet only")
    out.parent.mkdir(parents=True, exist_ok=True)
    save_trace(file, out)
    typer.echo(out)


def _check_target(file: Path, out: Path, to: str) -> None:
    """Refuse unknown formats, and to write over a record.

    Raises:
        ValueError: If so.
    """
    if to not in FORMATS:
        raise ValueError(f"--to is {to}; choose one of {', '.join(FORMATS)}")
    if out.suffix.lower() != FORMATS[to]:
        raise ValueError(f"--out is {out}; give a name that ends in {FORMATS[to]}")
    if out.exists() and (to == "parquet" or (file.exists() and out.samefile(file))):
        raise ValueError(f"--out is {out}, which exists; choose another name")


def _write(record: TrialRecord, out: Path, to: str) -> None:
    """Write the record in a format."""
    if to == "parquet":
        from costeer.records.record import write_record

        write_record(out, record)
        return
    from costeer.export.mcap import write_mcap

    write_mcap(record, out)
