"""Options by which a user replaces parts of the loop; several commands share them."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, NamedTuple

import typer

from costeer.cli.console import note
from costeer.cli.units import parse_length, parse_speed

if TYPE_CHECKING:
    from costeer.scenarios.definition import Scenario as Definition
    from costeer.scenarios.reading import Chosen

Method = Annotated[
    str,
    typer.Option(
        help="Method that guides in assisted trials: a name from "
        "`costeer methods`, module:object or FILE.py."
    ),
]
Car = Annotated[
    str, typer.Option(help="Car: default, compact, large, or a FILE.yaml of your own.")
]
_DRIVER = (
    "Driver: virtual, virtual-traffic, virtual-2 (the earlier population), hands-off, "
    "a driver saved by `costeer drivers --fit --out` (FILE.yaml), a driver model "
    "(module:object or FILE.py), or a record whose hands are replayed (FILE.parquet)"
)
Scenario = Annotated[
    str,
    typer.Option(
        help="Scenario (road, other cars, events): a name from `costeer "
        "scenario list`, or FILE.yaml."
    ),
]
Mistakes = Annotated[
    list[str] | None,
    typer.Option(
        "--mistake",
        metavar="NAME[=SIZE]",
        help="Mistake to make on purpose, such as late-trigger=0.8; "
        "repeatable. `costeer scenario mistakes` lists them.",
    ),
]
Length = Annotated[
    float | None,
    typer.Option(
        parser=parse_length,
        show_default="of the scenario",
        metavar="LENGTH",
        help="Length of the course [m], or with a unit, such as 3km.",
    ),
]
Speed = Annotated[
    float | None,
    typer.Option(
        parser=parse_speed,
        show_default="of the scenario",
        metavar="SPEED",
        help="Suggested speed, also that at the start [m/s], or with a "
        "unit, such as 70km/h.",
    ),
]
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
        help="Predictor that reads the intention: gru, another that "
        "`costeer evaluate` knows, module:object or FILE.py.",
    ),
]
Weights = Annotated[
    Path | None,
    typer.Option(
        help="Weights of the predictor (FILE.npz), or a whole network (FILE.onnx)."
    ),
]
ExactNetwork = Annotated[
    bool,
    typer.Option(
        "--exact-network",
        help="Take every verdict of the network from its exact window, even if it has "
        "passed the check of its cheaper form.",
    ),
]
Assignments = Annotated[
    list[str] | None,
    typer.Option(
        "--set",
        metavar="NAME=NUMBER",
        help="Value of any parameter, such as "
        "guidance.lateral_error_gain=3; repeatable. `costeer "
        "parameters` lists them.",
    ),
]
ParameterFile = Annotated[
    Path | None,
    typer.Option("--parameters", help="FILE.yaml with values of parameters."),
]

Values = tuple[tuple[str, float], ...]


def chosen_scenario(given: str, length: float | None, speed: float | None) -> Chosen:
    """A scenario with the length and speed that are driven; notes are told.

    Raises:
        ValueError: If there is none, or a curve is too tight for the speed.
        OSError: If its file cannot be read.
    """
    from costeer.scenarios.reading import chosen

    found = chosen(given, length, speed)
    for each in found.notes:
        note(f"costeer: {each}")
    return found


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


class Reader(NamedTuple):
    """What reads the intention, as the options of a command name it."""

    predictor: str
    weights: Path | None
    method: str


def values_with_threshold(
    file: Path | None, words: list[str] | None, reader: Reader
) -> Values:
    """As `chosen_values`, with the threshold that adapted weights bring along.

    Raises:
        ValueError: If something sets nothing, or the weights are none.
        OSError: If a file cannot be read.
    """
    values = chosen_values(file, words)
    if reader.weights is None:
        return values
    from costeer.training.thresholds import NAME, with_threshold

    found = with_threshold(dict(values), *reader)
    if len(found) > len(values):
        note(
            f"costeer: {NAME} is {found[NAME]:.4g}, as {reader.weights} says; --set "
            "changes it"
        )
    return tuple(found.items())


def weights_path(weights: Path | None) -> str | None:
    """The file of a predictor's numbers as trials name it."""
    return None if weights is None else str(weights)


def tell_of_bends(
    scenarios: Iterable[str | Definition],
    intention: str,
    predictor: str = "gru",
    weights: Path | None = None,
) -> None:
    """Say that the network which comes with costeer has seen straight roads alone.

    Args:
        scenarios: To be driven; names and files, too.
        intention: Where the crossing probability comes from.
        predictor: That was asked for.
        weights: Its file.
    """
    from costeer.intention.predictors.registry import OURS
    from costeer.scenarios.reading import scenario_named

    if (intention, predictor, weights) != ("network", OURS, None):
        return
    bent = [each.name for each in map(scenario_named, scenarios) if each.road.stations]
    if bent:
        note(
            f"costeer: {', '.join(bent)} has bends, and the network that comes with "
            "costeer has seen straight roads alone: it triggers falsely more often "
            "there, in bends of 500 m and more about once in ten kilometres, in "
            "tighter ones more often still; see docs/intention.md"
        )
