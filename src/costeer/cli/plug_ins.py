"""Options by which a user replaces parts of the loop; three commands share them."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

Method = Annotated[
    str,
    typer.Option(
        help="Guidance of assisted trials: ibhs, the name of an installed plug-in, "
        "module:object or FILE.py."
    ),
]
Car = Annotated[
    str, typer.Option(help="default, compact, large, or a FILE.yaml of its own.")
]
_DRIVER = (
    "virtual, hands-off, a driver of `costeer drivers --fit --out` (FILE.yaml), a "
    "driver model (module:object or FILE.py), or a record whose hands are replayed "
    "(FILE.parquet)"
)
Driver = Annotated[str, typer.Option("--driver", "--driver-file", help=f"{_DRIVER}.")]
Drivers = Annotated[
    list[str] | None,
    typer.Option(
        "--driver",
        "--driver-file",
        show_default="virtual",
        help=f"{_DRIVER}; several take turns.",
    ),
]
PredictorName = Annotated[
    str,
    typer.Option(
        "--predictor",
        help="What reads the intention: gru, another of `costeer evaluate`, "
        "module:object or FILE.py.",
    ),
]
Weights = Annotated[
    Path | None,
    typer.Option(help="Numbers of the predictor, FILE.npz; or a network, FILE.onnx."),
]
Assignments = Annotated[
    list[str] | None,
    typer.Option(
        "--set",
        metavar="NAME=NUMBER",
        help="Any parameter, as guidance.lateral_error_gain=3; may be repeated. "
        "`costeer parameters` lists them.",
    ),
]
ParameterFile = Annotated[
    Path | None, typer.Option("--parameters", help="Parameters of a FILE.yaml.")
]

Values = tuple[tuple[str, float], ...]


def chosen_values(file: Path | None, words: list[str] | None) -> Values:
    """Parameters of a file, and after them those of the command line.

    Raises:
        ValueError: If one of them sets nothing.
        OSError: If the file cannot be read.
    """
    if file is None and not words:
        return ()
    from costeer.loop.inputs import parse_assignments, read_values

    values = {} if file is None else read_values(file)
    return tuple({**values, **parse_assignments(words or [])}.items())


def weights_path(weights: Path | None) -> str | None:
    """The file of a predictor's numbers as trials name it."""
    return None if weights is None else str(weights)
