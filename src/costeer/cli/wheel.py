"""`costeer wheel`: list, calibrate and test steering wheels."""

from __future__ import annotations

import math
from typing import Annotated

import typer

from costeer.cli.validate import at_least, in_range

_CALIBRATE_ONLY = "--peak-torque --weight --radius --range --no-turns --no-pedals"


def wheel(
    action: Annotated[str, typer.Argument(help="One of list, calibrate, test.")],
    device: Annotated[
        int | None,
        typer.Option(
            metavar="N",
            callback=at_least(1),
            help="Number of the wheel in the list; by default the first.",
        ),
    ] = None,
    can: Annotated[
        str | None,
        typer.Option(
            metavar="BUS", help="CAN bus of a SENSO-Wheel, such as pcan:PCAN_USBBUS1."
        ),
    ] = None,
    simulated: Annotated[
        bool,
        typer.Option("--simulated", help="Use a simulated wheel, to try the command."),
    ] = False,
    peak_torque: Annotated[
        float | None,
        typer.Option(
            metavar="NM",
            callback=in_range(0.1, 50),
            help="With calibrate: torque at full command [N·m]; by default "
            "from a table of known devices.",
        ),
    ] = None,
    weight: Annotated[
        float | None,
        typer.Option(
            metavar="KG",
            callback=in_range(0.05, 20),
            help="With calibrate: mass hung from the rim [kg].",
        ),
    ] = None,
    radius: Annotated[
        float | None,
        typer.Option(
            metavar="M",
            callback=in_range(0.05, 0.5),
            help="With --weight: radius of the rim [m].",
        ),
    ] = None,
    range_deg: Annotated[
        float | None,
        typer.Option(
            "--range",
            metavar="DEG",
            callback=in_range(40, 2520),
            help="With calibrate: range from lock to lock [deg], if the "
            "device reports it wrongly.",
        ),
    ] = None,
    no_turns: Annotated[
        bool,
        typer.Option(
            "--no-turns",
            help="With calibrate: trust the maker's sign of the angle "
            "instead of asking for turns.",
        ),
    ] = False,
    no_pedals: Annotated[
        bool, typer.Option("--no-pedals", help="With calibrate: skip the pedals.")
    ] = False,
) -> None:
    """List, calibrate and test steering wheels.

    The calibration takes a minute: the user turns the wheel to both ends and presses
    the pedals, then the wheel moves by itself, without hands, for half of it. It finds
    signs, range, torque curve, inertia, damping, friction and latency, and keeps them
    for this device in the user's folder. The torque needs one reference: the peak
    torque of the device, or a weight on a cord over the rim.

    Example:
        costeer wheel list
        costeer wheel calibrate --weight 1 --radius 0.14
        costeer wheel test
        costeer wheel calibrate --simulated
    """
    from costeer.cli import wheel_session as session

    given = {
        "--peak-torque": peak_torque is not None,
        "--weight": weight is not None,
        "--radius": radius is not None,
        "--range": range_deg is not None,
        "--no-turns": no_turns,
        "--no-pedals": no_pedals,
        "--device": device is not None,
        "--can": can is not None,
        "--simulated": simulated,
    }
    _check(action, {name for name, value in given.items() if value})
    if action == "list":
        session.show_wheels(can or "")
        return
    chosen = session.chosen(device, can or "", simulated)
    if action == "test":
        session.check(chosen)
        return
    reference = session.known(
        chosen,
        peak_torque,
        None if weight is None or radius is None else (weight, radius),
        None if range_deg is None else math.radians(range_deg),
        not no_turns,
    )
    session.calibrate(chosen, reference, pedals=not no_pedals)


def _check(action: str, given: set[str]) -> None:
    """Refuse what contradicts, and options that would do nothing.

    Raises:
        ValueError: If there are any.
    """
    useless = {
        "calibrate": set(),
        "test": set(_CALIBRATE_ONLY.split()),
        "list": {*_CALIBRATE_ONLY.split(), "--device", "--simulated"},
    }
    if action not in useless:
        raise ValueError(f"{action!r} is no action; give list, calibrate or test")
    if unused := sorted(given & useless[action]):
        raise ValueError(f"{action} does not use {' and '.join(unused)}; leave it out")
    if ("--weight" in given) != ("--radius" in given):
        raise ValueError("a weight pulls at a radius: give --weight and --radius")
    if {"--weight", "--peak-torque"} <= given:
        raise ValueError("give --peak-torque, or --weight and --radius, not both")
    if {"--range", "--no-turns"} <= given:
        raise ValueError("--range needs the turns; leave --no-turns out")
    if len(several := sorted(given & {"--device", "--can", "--simulated"})) > 1:
        raise ValueError(f"give one of {' and '.join(several)}")
