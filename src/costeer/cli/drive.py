"""`costeer drive`: a person at the wheel, in the browser."""

from __future__ import annotations

import signal
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from costeer.cli import plug_ins
from costeer.cli.console import note

if TYPE_CHECKING:
    from starlette.types import ASGIApp

    from costeer.web.drive import DriveOnPages
    from costeer.web.security import Access
    from costeer.web.serving import Running


def drive(
    condition: Annotated[
        str,
        typer.Option(
            help="Condition: manual, or a strength and a duration, such as weak-gentle."
        ),
    ] = "strong-normal",
    method: plug_ins.Method = "ibhs",
    record: Annotated[
        Path | None, typer.Option(help="Trial record to write, FILE.parquet.")
    ] = None,
    wheel: Annotated[
        str,
        typer.Option(
            help="What steers: auto (a calibrated wheel if there is one), "
            "keyboard, gamepad, simulated[:keys, :virtual or "
            ":FILE.csv], a number from `costeer wheel list`, or "
            "can:BUS:CHANNEL."
        ),
    ] = "auto",
    head: Annotated[
        str,
        typer.Option(
            help="Head tracker: none, calibrated (the one set up by `costeer"
            " head calibrate`), webcam[:N or FILE], lsl:NAME or "
            "opentrack[:PORT]."
        ),
    ] = "none",
    intention: Annotated[
        str,
        typer.Option(help="What starts a lane change: network, indicator or off."),
    ] = "network",
    participant: Annotated[
        str,
        typer.Option(
            help="Pseudonym of the participant; selects the calibration of "
            "the head tracker."
        ),
    ] = "1",
    seed: Annotated[int, typer.Option(help="Seed of the leading cars.")] = 1,
    scenario: plug_ins.Scenario = "expressway",
    length: plug_ins.Length = None,
    speed: plug_ins.Speed = None,
    car: plug_ins.Car = "default",
    predictor: plug_ins.PredictorName = "gru",
    weights: plug_ins.Weights = None,
    assignments: plug_ins.Assignments = None,
    parameters: plug_ins.ParameterFile = None,
    events: Annotated[
        bool,
        typer.Option(
            "--events/--no-events", help="Place slower cars ahead, to be overtaken."
        ),
    ] = True,
    cruise: Annotated[
        bool,
        typer.Option(
            "--cruise/--no-cruise", help="Hold the speed while no pedal is pressed."
        ),
    ] = True,
    signals: Annotated[
        bool,
        typer.Option(
            "--signals/--no-signals", help="Show signals on the driver's page."
        ),
    ] = True,
    lsl: Annotated[
        bool,
        typer.Option("--lsl", help="Send state and markers to Lab Streaming Layer."),
    ] = False,
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
    """Drive yourself, with wheel, gamepad or keyboard; Ctrl-C ends it.

    Example:
        costeer drive
        costeer drive --condition weak-gentle --record out/me.parquet
        costeer drive --scenario expressway-curves
    """
    from costeer.cli.devices import chosen_head, chosen_wheel, pseudonym_number
    from costeer.loop.inputs import car_of
    from costeer.loop.scenario import TrialSetup
    from costeer.runtime.setup import DriveSetup
    from costeer.runtime.stream import check_free
    from costeer.web.drive import DriveOnPages, PageOptions

    if record is not None:
        check_free(record)
    course = plug_ins.chosen_scenario(scenario, length, speed)
    trial = TrialSetup(
        condition=condition,
        method=method,
        participant=pseudonym_number(participant),
        seed=seed,
        length=course.length,
        speed=course.speed,
        scenario=course.scenario,
        car=car_of(car),
        events=events,
        predictor=predictor,
        weights=plug_ins.weights_path(weights),
        parameters=plug_ins.values_with_threshold(
            parameters, assignments, plug_ins.Reader(predictor, weights, method)
        ),
    )
    chosen = chosen_wheel(wheel)
    setup = DriveSetup(
        trial=trial,
        wheel=chosen.description,
        calibration=chosen.calibration,
        intention=intention,
        keeps_speed=cruise,
        head=chosen_head(head, participant),
        participant=participant,
    )
    plug_ins.tell_of_bends([course.scenario], intention, predictor, weights)
    options = PageOptions(input=chosen.input, show_signals=signals)
    access = _access(host, port)  # before anything is started
    _run_to_its_end(DriveOnPages(setup, record, options), access, browser, lsl)


def _access(host: str, port: int) -> Access:
    """Who may open the page; refused if it could not be served."""
    from costeer.web.security import access_for
    from costeer.web.serving import listening

    access = access_for(host, port)
    listening(host, port).close()
    return access


def _run_to_its_end(
    session: DriveOnPages, access: Access, browser: bool, lsl: bool
) -> None:
    """Drive until someone stops it; whatever happens, the record becomes whole."""
    for name in ("SIGTERM", "SIGHUP", "SIGBREAK"):
        if hasattr(signal, name):
            signal.signal(getattr(signal, name), _stop)
    try:
        if lsl:
            send_to_lsl(session)
        run_drive(session, access, browser)
    finally:
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, signal.SIG_IGN)  # not to be cut short
        session.stop()
    tell_end(session)


def _stop(*_: object) -> None:
    """End as Ctrl-C does, so that the record is made whole."""
    raise KeyboardInterrupt


def send_to_lsl(session: DriveOnPages) -> None:
    """Send the session's frames and markers to Lab Streaming Layer, too.

    Raises:
        ModuleNotFoundError: If `pylsl` is not installed.
    """
    import time

    from costeer.export.lsl import TrialOutlet, lsl_clock
    from costeer.runtime.frame import PLACE

    outlet = TrialOutlet({column.name: column.unit for column in session.columns})
    later = lsl_clock() - time.perf_counter()
    session.also(
        lambda frame: outlet.push(
            frame[: len(session.columns)].tolist(), frame[PLACE["sent_time"]] + later
        ),
        outlet.mark,
    )


def run_drive(session: DriveOnPages, access: Access, browser: bool) -> None:
    """Start the processes, serve the pages until Ctrl-C or the experimenter's stop."""
    from costeer.runtime.clock import favour_thread
    from costeer.web.app import drive_app
    from costeer.web.serving import Ending, open_page, serve

    note("costeer: starting; the very first start compiles for up to a minute")
    session.drive.start()

    def make_app(taken: Access) -> ASGIApp:
        return drive_app(session, taken)

    def announce(running: Running) -> None:
        session.on_stop = running.stop
        typer.echo(f"drive at:        {running.address}")
        typer.echo(f"experimenter at: {running.experimenter_address}")
        note(f"costeer: real-time process: {session.drive.priority}; Ctrl-C ends")
        for loss in session.drive.losses:
            note(f"costeer: {loss.text}")
        if browser:
            open_page(running.address)

    favour_thread()
    with suppress(KeyboardInterrupt):
        serve(make_app, access, announce, Ending(session.end_soon, session.say_goodbye))


def tell_end(session: DriveOnPages) -> None:
    """Print what is left of the drive.

    Raises:
        typer.Exit: With 1 if something that was driven could not be kept.
    """
    for line in session.account():
        note(f"costeer: {line}")
    for path in session.drive.kept:
        typer.echo(path)
    for line in session.drive.unkept:
        note(f"costeer: {line}")
    if session.drive.unkept:
        raise typer.Exit(1)
