"""`costeer session`: a study with people, from consent to report."""

from __future__ import annotations

import signal
from contextlib import suppress
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, NamedTuple

import typer

from costeer.cli.console import note, print_table
from costeer.cli.session_trial import Rehearsal, power, rehearse_study

if TYPE_CHECKING:
    from starlette.types import ASGIApp

    from costeer.sessions.plan import Plan
    from costeer.sessions.session import Session
    from costeer.web.security import Access
    from costeer.web.serving import Running
    from costeer.web.sessions.desk import Desk
    from costeer.web.sessions.devices import Devices

ACTIONS = ("new", "run", "status", "export", "withdraw", "power", "rehearse")


def session(
    action: Annotated[str, typer.Argument(help="One of " + ", ".join(ACTIONS) + ".")],
    folder: Annotated[Path, typer.Argument(help="Folder of the study.")],
    plan: Annotated[
        Path | None,
        typer.Option(help="With new or power: file with a plan of your own."),
    ] = None,
    participant: Annotated[
        str | None,
        typer.Option(help="With withdraw: participant whose data are deleted."),
    ] = None,
    wheel: Annotated[
        str,
        typer.Option(help="With run: a steering wheel, as in `costeer drive --help`."),
    ] = "auto",
    head: Annotated[
        str,
        typer.Option(help="With run: a head tracker, as in `costeer drive --help`."),
    ] = "none",
    port: Annotated[
        int, typer.Option(help="With run: port of the pages; 0 takes any free one.")
    ] = 8700,
    host: Annotated[
        str,
        typer.Option(
            help="With run: address to listen on; other computers need a token."
        ),
    ] = "127.0.0.1",
    browser: Annotated[
        bool,
        typer.Option(
            "--browser/--no-browser", help="With run: open the console in a browser."
        ),
    ] = True,
    to: Annotated[
        str,
        typer.Option(
            "--format",
            help="With export: format, csv, bids, matlab, mcap, autoui or all.",
        ),
    ] = "csv",
    out: Annotated[
        Path | None, typer.Option(help="With export: new folder to write into.")
    ] = None,
    haste: Annotated[
        float | None,
        typer.Option(
            help="With rehearse, or run --wheel simulated:virtual: how many "
            "times faster than real time drives run."
        ),
    ] = None,
    participants: Annotated[
        int, typer.Option(help="With rehearse: number of simulated participants.")
    ] = 12,
    accidents: Annotated[
        float,
        typer.Option(
            help="With rehearse: number of times per minute that something is killed."
        ),
    ] = 0.5,
    conditions: Annotated[
        str,
        typer.Option(
            help="With rehearse: conditions of the assisted trials, "
            "separated by commas."
        ),
    ] = "",
    length: Annotated[
        float, typer.Option(help="With rehearse: length of a trial [m].")
    ] = 300.0,
    scenario: Annotated[
        str, typer.Option(help="With rehearse: scenario that ships with costeer.")
    ] = "expressway",
    seed: Annotated[
        int, typer.Option(help="With rehearse and power: seed of everything random.")
    ] = 1,
    drivers: Annotated[
        int,
        typer.Option(help="With power: number of virtual drivers who drive the plan."),
    ] = 40,
    intention: Annotated[
        str,
        typer.Option(
            help="With power: what tells the system of a lane change, "
            "network or scripted."
        ),
    ] = "network",
) -> None:
    """Run a study with people: plan, questionnaires, drives, data.

    `new` writes the plan of the paper's experiment into a folder; edit it as
    docs/session.md explains. `power` predicts how many participants are needed. `run`
    serves the participant's page and the experimenter's console and prints their
    addresses. `status` shows how far each participant has got, `export` writes the data
    for other programs, `withdraw` deletes everything about a participant. `rehearse`
    sends simulated participants through the paper's plan in a folder of its own.
    `costeer report` evaluates the study.

    Example:
        costeer session new my-study
        costeer session power my-study
        costeer session run my-study
        costeer session status my-study
        costeer session export my-study --format bids --out shared
        costeer session withdraw my-study --participant P01
        costeer session rehearse my-rehearsal --participants 2
        costeer report my-study
    """
    rehearsal = Rehearsal(
        participants, seed, accidents, haste, conditions, length, scenario
    )
    lab = _Lab(wheel, head, 1.0 if haste is None else haste)
    acts = {
        "new": partial(_new, folder, plan),
        "run": partial(_run, folder, lab, (host, port), browser),
        "status": partial(_status, folder),
        "export": partial(_export, folder, to, out),
        "withdraw": partial(_withdraw, folder, participant),
        "power": partial(power, folder, plan, drivers, seed, intention),
        "rehearse": partial(rehearse_study, folder, rehearsal),
    }
    if action not in acts:
        known = ", ".join(acts)
        raise ValueError(f"there is no action '{action}'; choose one of {known}")
    acts[action]()


def _new(folder: Path, plan: Path | None) -> None:
    """Make the folder of a study.

    Raises:
        ValueError: If it holds a study already, or the plan cannot be.
        OSError: If it cannot be written.
    """
    from costeer.base.files import read_whole, write_text
    from costeer.sessions.balance import balance
    from costeer.sessions.plan import PLAN_FILE
    from costeer.sessions.plan_file import LARGEST, paper_plan_text, parsed_plan
    from costeer.sessions.plan_words import check_words
    from costeer.sessions.scenarios import is_file_name, scenario_texts

    text = paper_plan_text().encode() if plan is None else read_whole(plan, LARGEST)
    found = parsed_plan(text, str(plan or PLAN_FILE))
    check_words(found, folder)
    target = folder / PLAN_FILE
    if target.exists():
        raise ValueError(
            f"{folder} has a {PLAN_FILE} already; edit that, or give another folder"
        )
    folder.mkdir(parents=True, exist_ok=True)
    own = Path() if plan is None else plan.parent
    for name, scenario in scenario_texts(found, own).items():
        if is_file_name(name):
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            write_text(folder / name, scenario)
    write_text(target, text.decode("utf-8"))
    _tell(found, own, folder)
    even = balance(found, range(1, found.participants + 1)).is_even
    told = "balanced" if even else "not balanced over so many"
    typer.echo(target)
    note(
        f"costeer: {found.participants} participants, {told}; edit the plan, then run:"
    )
    note(f"costeer session run {folder}")


def _tell(plan: Plan, own: Path, folder: Path) -> None:
    """Notes on a plan.

    Args:
        plan: Of the study.
        own: Where its scenarios lie.
        folder: Of the study.
    """
    from costeer.cli.plug_ins import tell_of_bends
    from costeer.sessions.plan_words import blank_notes
    from costeer.sessions.scenarios import (
        scenario_beside,
        scenario_names,
        scenario_notes,
    )

    for told in (*scenario_notes(plan, own), *blank_notes(plan, folder)):
        note(f"costeer: {told}")
    driven = [scenario_beside(name, own) for name in scenario_names(plan)]
    tell_of_bends(driven, plan.intention)


class _Lab(NamedTuple):
    """What participants drive with, in words."""

    wheel: str
    head: str
    haste: float


def _run(folder: Path, lab: _Lab, where: tuple[str, int], browser: bool) -> None:
    """Serve both pages until Ctrl-C."""
    from costeer.sessions.plan_words import check_words
    from costeer.sessions.session import Session
    from costeer.study.locks import locked
    from costeer.web.security import access_for
    from costeer.web.serving import listening
    from costeer.web.sessions.desk import Desk

    devices = _devices(lab, folder)
    access = access_for(*where)
    listening(*where).close()  # before anything is opened
    for name in ("SIGTERM", "SIGHUP", "SIGBREAK"):
        if hasattr(signal, name):
            signal.signal(getattr(signal, name), _stop)
    session = Session(folder)
    check_words(session.plan, folder)
    _tell(session.plan, folder, folder)
    _compile(session, devices)
    with locked(folder):  # a second one would take running drives for aborted
        desk = Desk(session, devices)
        try:
            _serve(desk, access, browser)
        finally:
            for number in (signal.SIGINT, signal.SIGTERM):
                signal.signal(number, signal.SIG_IGN)  # not to be cut short
            desk.close()
    if desk.trouble:
        note(f"costeer: {desk.trouble}")
        raise typer.Exit(1)


def _compile(session: Session, devices: Devices) -> None:
    """Have the machine code of all drives ready before anybody waits for it."""
    from costeer.runtime.cabin import Cabin
    from costeer.runtime.setup import DriveSetup, check_drive
    from costeer.sessions.plan import session_steps, trial_of

    plan, version = session.plan, session.plan_version
    steps = {(s.method, s.scenario): s for s in session_steps(plan, 1) if s.drives}
    for step in steps.values():
        scenario = session.versions.scenario(version, step.scenario)
        trial = trial_of(plan, step, 1, scenario)
        setup = DriveSetup(trial, devices.wheel, devices.calibration)
        check_drive(setup._replace(haste=devices.haste))
        Cabin(setup).warm_up()


def _stop(*_: object) -> None:
    raise KeyboardInterrupt


def _devices(lab: _Lab, folder: Path) -> Devices:
    """What participants drive with.

    Raises:
        ValueError: If there is no such wheel or head tracker.
    """
    from costeer.cli.devices import chosen_head, chosen_wheel
    from costeer.doctor import lab_checks
    from costeer.web.sessions.devices import Devices

    chosen = chosen_wheel(lab.wheel)
    return Devices(
        input=chosen.input,
        wheel=chosen.description,
        calibration=chosen.calibration,
        head=lambda who: chosen_head(lab.head, who),
        checks=lambda: lab_checks(folder, chosen.description, lab.head),
        haste=lab.haste,
    )


def _serve(desk: Desk, access: Access, browser: bool) -> None:
    """Answer both pages until someone stops it."""
    from costeer.runtime.clock import favour_thread
    from costeer.web.serving import open_page, serve
    from costeer.web.sessions.app import session_app

    def make_app(taken: Access) -> ASGIApp:
        return session_app(desk, taken)

    def announce(running: Running) -> None:
        console = running.experimenter_address.replace("/?", "/console?")
        typer.echo(f"participant at: {running.address}")
        typer.echo(f"console at:     {console}")
        note("costeer: Ctrl-C ends; what was answered and driven is kept")
        if browser:
            open_page(console)

    favour_thread()
    with suppress(KeyboardInterrupt):
        serve(make_app, access, announce)


def _status(folder: Path) -> None:
    """Print who takes part and where each stands."""
    from costeer.sessions.session import Session
    from costeer.sessions.withdrawal import num_withdrawn

    session = Session(folder)
    rows = []
    for row in session.people():
        standing = session.standing(row["participant"])
        rows.append(
            [
                row["participant"],
                str(row["slot"]),
                row["status"],
                standing.step.id,
                f"{standing.number - 1} of {standing.of}",
                row["reason"],
            ]
        )
    heads = ["participant", "row of orders", "status", "at", "steps done", "reason"]
    if rows:
        print_table(heads, rows)
    gone = num_withdrawn(session)
    session.close()
    if not rows:
        note("costeer: no participants; they begin on the console of:")
        note(f"costeer session run {folder}")
    if gone:
        note(f"costeer: {gone} withdrew; nothing of them is left")


def _export(folder: Path, to: str, out: Path | None) -> None:
    """Write the data for other programs.

    Raises:
        ValueError: If it cannot be, or there is no folder to write into.
        OSError: If a file cannot be read or written.
    """
    from costeer.sessions.export import export_session

    if out is None:
        raise ValueError("where to? give --out and a new folder")
    people = export_session(folder, to, out)
    typer.echo(out)
    note(
        f"costeer: {len(people.all_drives)} trials; excluded or missing: "
        f"{len(people.exclusions)}, exclusions.csv of --format csv says why"
    )


def _withdraw(folder: Path, participant: str | None) -> None:
    """Delete all of a participant.

    Raises:
        ValueError: If there is none.
        OSError: If something could not be deleted.
    """
    from costeer.sessions.session import Session
    from costeer.sessions.withdrawal import withdraw
    from costeer.study.locks import locked

    if not participant:
        raise ValueError("whose data? give --participant P01")
    session = Session(folder)
    with locked(folder):  # whose session runs withdraws on the console
        files = withdraw(session, participant)
        session.close()
    typer.echo(f"{participant}: {files} files and every row deleted")
