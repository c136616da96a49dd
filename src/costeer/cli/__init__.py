"""The command line: one file per command, imported only when it is called.

A command is a function that bears the name of its file; its docstring ends with an
example. The table below lets `costeer --help` list the commands without importing
what they need. Errors leave as one line on stderr: cli/errors.py.
"""

from __future__ import annotations

import logging
import os
import sys
from importlib import import_module
from pathlib import Path
from typing import Annotated

import typer

from costeer.cli.compiling import announce
from costeer.cli.console import release_notes
from costeer.cli.encoding import write_any_text
from costeer.cli.errors import BAD_INPUT, exit_code_of
from costeer.cli.group import LazyGroup

__all__ = ["app", "main"]


DEBUG = "--debug"


class CommandGroup(LazyGroup):
    """The commands of costeer and what each does, in one line."""

    summaries = {  # noqa: RUF012  because Typer builds the class without arguments
        "study": "Run the whole experiment with virtual drivers, then the report.",
        "simulate": "Simulate one trial, write its record and summarise what happened.",
        "drivers": "Draw, plot, validate and fit virtual drivers.",
        "parameters": "List every parameter that --set can change: value, unit, range, "
        "source.",
        "methods": "List the methods of assistance, costeer's own and installed "
        "plug-ins.",
        "train": "Fit the intention network on records.",
        "emergencies": "Let an obstacle appear ahead, and compare the outcomes.",
        "compare": "Compare methods of assistance on the same drivers, roads and "
        "noise.",
        "evaluate": "Judge the intention network on records or a table.",
        "analyse": "Compute driving measures from records or a table.",
        "report": "Rewrite the tables, tests, figures and report.html of a study.",
        "merge": "Join the shards of a study, and write its tables and report.",
        "sensitivity": "Find which guidance parameters matter most, by Sobol indices.",
        "drive": "Drive yourself, with wheel, gamepad or keyboard; Ctrl-C ends it.",
        "session": "Run a study with people: plan, questionnaires, drives, data.",
        "scenario": "List, show, draw, make and export scenarios: roads, other cars, "
        "events.",
        "replay": "Show a recorded trial in the browser; Ctrl-C ends it.",
        "wheel": "List, calibrate and test steering wheels.",
        "head": "Calibrate the tracker of a participant's head, or show what it sees.",
        "export": "Write a record for other programs, or a study for other people.",
        "bench": "Measure the speed of the control step, a trial, a batch or a drive.",
        "doctor": "Show what this computer has and how to fix what is missing.",
    }
    package = "costeer.cli"


app = typer.Typer(cls=CommandGroup, rich_markup_mode=None)


def _print_version(asked: bool) -> None:
    """Print the version and stop, if asked."""
    if asked:
        typer.echo(f"costeer {import_module('costeer').__version__}")
        raise typer.Exit


@app.callback()
def costeer(
    version: Annotated[
        bool,
        typer.Option(
            "--version",
            callback=_print_version,
            is_eager=True,
            help="Show the version.",
        ),
    ] = False,
    debug: Annotated[
        bool,
        typer.Option(DEBUG, help="Show the traceback of an error."),
    ] = False,
) -> None:
    """Intention-based haptic guidance steering: simulate, study, analyse.

    Example:
        costeer study --out out/study
    """


def main(arguments: list[str] | None = None) -> int:
    """Run the command line; return its exit code.

    0; 2 for bad input, 70 for a mistake in costeer, 130 if stopped.

    Args:
        arguments: Words after `costeer`; those of the process if None.
    """
    words = sys.argv[1:] if arguments is None else arguments
    if DEBUG in words:
        words = [word for word in words if word != DEBUG]
        os.environ["COSTEER_TRACEBACK"] = "1"
    _open_closed_streams()
    write_any_text()
    announce()
    # It warns at length where the home folder cannot be written, then works.
    logging.getLogger("matplotlib").setLevel(logging.ERROR)
    command = typer.main.get_command(app)
    if os.environ.get("NUMBA_DISABLE_JIT", "0") not in ("", "0"):
        print(
            "costeer: NUMBA_DISABLE_JIT is set, and costeer needs compiled code; unset "
            "it",
            file=sys.stderr,
        )
        return BAD_INPUT
    code = exit_code_of(
        lambda: command.main(
            words or ["--help"], prog_name="costeer", standalone_mode=False
        )
    )
    release_notes(told=code != BAD_INPUT)
    return code


def _open_closed_streams() -> None:
    """Give a process that was started without stdout or stderr a place to write."""
    for name in ("stdout", "stderr"):
        if getattr(sys, name) is None:
            setattr(sys, name, Path(os.devnull).open("w"))  # noqa: SIM115  stays open
