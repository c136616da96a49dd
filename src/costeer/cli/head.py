"""`costeer head`: calibrate the tracker of a participant's head, or try it out."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from costeer.cli.validate import in_range

if TYPE_CHECKING:
    from costeer.devices.head.source import HeadDescription

MIRROR_ANGLE = 30.0
"""Where the marks or mirrors are if not said [deg]."""


def head(
    action: Annotated[str, typer.Argument(help="One of calibrate, test.")],
    participant: Annotated[
        str | None,
        typer.Option(metavar="P", help="Pseudonym of the participant, such as P01."),
    ] = None,
    camera: Annotated[
        str | None,
        typer.Option(
            metavar="N|FILE",
            help="Number of the webcam, or a video file; by default 0.",
        ),
    ] = None,
    lsl: Annotated[
        str | None,
        typer.Option(
            metavar="NAME", help="Name of the LSL stream of a professional tracker."
        ),
    ] = None,
    opentrack: Annotated[
        str | None,
        typer.Option(metavar="PORT", help="Port of opentrack, such as 4242."),
    ] = None,
    channel: Annotated[
        str | None,
        typer.Option(help="With --lsl: label of the channel that holds the yaw."),
    ] = None,
    unit: Annotated[
        str | None,
        typer.Option(
            help="With --lsl: unit, rad or deg, if the stream does not state it."
        ),
    ] = None,
    validity: Annotated[
        str | None,
        typer.Option(
            help="With --lsl: label of a channel that is above 0.5 while the"
            " yaw is valid."
        ),
    ] = None,
    mirrored: Annotated[
        bool,
        typer.Option(
            "--mirrored", help="The tracker counts yaw to the right as positive."
        ),
    ] = False,
    left: Annotated[
        float | None,
        typer.Option(
            metavar="DEG",
            callback=in_range(10, 60),
            help="With calibrate: angle from straight ahead to the left "
            "mirror [deg]; by default 30.",
        ),
    ] = None,
    right: Annotated[
        float | None,
        typer.Option(
            metavar="DEG",
            callback=in_range(10, 60),
            help="With calibrate: angle from straight ahead to the right "
            "mirror [deg]; by default 30.",
        ),
    ] = None,
    seconds: Annotated[
        float | None,
        typer.Option(
            callback=in_range(0.1, 3600), help="With test: duration [s]; by default 5."
        ),
    ] = None,
) -> None:
    """Calibrate the tracker of a participant's head, or show what it sees.

    The calibration asks for three looks: straight ahead, left mirror, right mirror. It
    stores the straight line through them and the tracker's name, and never a picture.
    With --participant alone, test uses the stored calibration.

    Example:
        costeer head calibrate --participant P01 --camera 0
        costeer head test --participant P01
        costeer head test --lsl SmartEye --channel HeadYaw --unit rad
    """
    from costeer.cli import head_session as session

    useless = {"calibrate": {"--seconds": seconds}}
    useless["test"] = {"--left": left, "--right": right}
    if action not in useless:
        raise ValueError(f"{action!r} is no action; give calibrate or test")
    _refuse_useless(action, useless[action])
    tracker = _tracker(
        {"webcam": camera, "lsl": lsl, "opentrack": opentrack},
        {"channel": channel, "unit": unit, "validity": validity},
        mirrored,
    )
    if action == "test":
        session.show_tracker(participant, tracker, seconds or 5.0)
        return
    if participant is None:
        raise ValueError("whose head is it? give --participant P, a pseudonym, as P01")
    angles = (left or MIRROR_ANGLE, right or MIRROR_ANGLE)
    session.calibrate(participant, tracker or _webcam(mirrored), angles)


def _refuse_useless(action: str, options: dict[str, float | None]) -> None:
    """Refuse options that would do nothing.

    Raises:
        ValueError: If there are any.
    """
    given = [name for name, value in options.items() if value is not None]
    if given:
        raise ValueError(f"{action} does not use {' and '.join(given)}; leave it out")


def _webcam(mirrored: bool) -> HeadDescription:
    """The tracker if none is named: the first camera."""
    from costeer.devices.head.source import HeadDescription

    return HeadDescription("webcam", "0", mirrored=mirrored)


def _tracker(
    addresses: dict[str, str | None], channels: dict[str, str | None], mirrored: bool
) -> HeadDescription | None:
    """The tracker that the options name; None if they name none.

    Raises:
        ValueError: If they name several, or channels of none.
    """
    from costeer.devices.head.source import HeadDescription

    named = {kind: address for kind, address in addresses.items() if address}
    told = {name: word for name, word in channels.items() if word}
    if len(named) > 1:
        raise ValueError("give one of --camera, --lsl and --opentrack")
    if told and "lsl" not in named:
        raise ValueError(f"--{' and --'.join(told)} need --lsl NAME")
    if told.get("unit", "rad") not in {"rad", "deg"}:
        raise ValueError(f"--unit is {told['unit']!r}; give rad or deg")
    for kind, address in named.items():
        return HeadDescription(kind, address, mirrored=mirrored, **told)
    return _webcam(mirrored) if mirrored else None
