"""`costeer replay`: a recorded trial in the browser, with a scrubber and signals."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from costeer.cli.console import note_all

if TYPE_CHECKING:
    from starlette.types import ASGIApp

    from costeer.web.security import Access
    from costeer.web.serving import Running


def replay(
    file: Annotated[
        Path,
        typer.Argument(help="Trial record, or a CSV or Parquet table in SI units."),
    ],
    port: Annotated[
        int, typer.Option(help="Port of the page; 0 takes any free one.")
    ] = 8700,
    host: Annotated[
        str,
        typer.Option(
            help="Address to listen on; anything but this computer requires a token."
        ),
    ] = "127.0.0.1",
    browser: Annotated[
        bool, typer.Option("--browser/--no-browser", help="Open the page in a browser.")
    ] = True,
) -> None:
    """Show a recorded trial in the browser; Ctrl-C ends it.

    Example:
        costeer replay out/trial.parquet
    """
    from costeer.records.record import read_noted
    from costeer.web.app import replay_app
    from costeer.web.replay import replay_of
    from costeer.web.security import access_for
    from costeer.web.serving import open_page, serve

    access = access_for(host, port)
    record, told = read_noted(file)
    note_all(file, told)
    try:
        shown = replay_of(record, file.name)
    except ValueError as error:
        raise ValueError(_with_file(file, error)) from error

    def make_app(taken: Access) -> ASGIApp:
        return replay_app(shown, taken)

    def announce(running: Running) -> None:
        typer.echo(f"replay of {file}: {running.address}")
        if browser:
            open_page(running.address)

    serve(make_app, access, announce)


def _with_file(file: Path, error: ValueError) -> str:
    """What was wrong, with the file's name in front, once."""
    told = str(error)
    return told if str(file) in told else f"{file}: {told}"
