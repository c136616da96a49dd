"""The short form of a rehearsal: one participant, accidents, nothing lost."""

from __future__ import annotations

import re
import threading
from http.server import BaseHTTPRequestHandler, HTTPServer
from pathlib import Path

import pytest

from costeer.runtime.setup import DriveSetup, check_drive
from costeer.scenarios.reading import scenario_named, shipped
from costeer.sessions import robot
from costeer.sessions.attempts import Attempts
from costeer.sessions.balance import balance
from costeer.sessions.plan import session_steps, trial_of
from costeer.sessions.plan_file import parsed_plan
from costeer.sessions.rehearsal_server import RehearsalServer
from costeer.sessions.rehearse import rehearsal_plan, rehearse
from costeer.sessions.robot import RehearsalSettings
from costeer.sessions.session import Session


def test_the_rehearsed_plan_is_the_papers_with_short_drives() -> None:
    plan = parsed_plan(rehearsal_plan(RehearsalSettings()))
    assert (plan.participants, plan.length) == (12, 300.0)
    assert balance(plan, range(1, 13)).is_even
    steps = session_steps(plan, 1)
    assert sum(each.kind == "drive" for each in steps) == 7
    assert all(each.minutes <= 0.1 for each in steps)


def test_a_folder_with_a_study_is_not_rehearsed_over(tmp_path: Path) -> None:
    (tmp_path / "plan.yaml").write_text("title: mine")
    with pytest.raises(ValueError, match="holds a study already"):
        rehearse(tmp_path, RehearsalSettings())
    assert (tmp_path / "plan.yaml").read_text() == "title: mine"


@pytest.mark.parametrize("wrong", [{"haste": 0.0}, {"participants": 0}, {"length": 1}])
def test_settings_that_cannot_be_leave_no_folder(
    tmp_path: Path, wrong: dict[str, float]
) -> None:
    settings = RehearsalSettings()._replace(**wrong)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match=f"{next(iter(wrong))} is"):
        rehearse(tmp_path / "study", settings)
    assert not (tmp_path / "study").exists()


@pytest.mark.parametrize("scenario", shipped())
def test_every_scenario_that_ships_can_be_rehearsed(scenario: str) -> None:
    plan = parsed_plan(rehearsal_plan(RehearsalSettings(scenario=scenario)))
    drives = [step for step in session_steps(plan, 1) if step.drives]
    assert {step.scenario for step in drives} == {scenario}
    for step in drives[:2]:  # a practice and a trial
        trial = trial_of(plan, step, 1, scenario_named(scenario))
        check_drive(DriveSetup(trial))


def test_a_scenario_of_ones_own_is_refused_before_anything_is_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "mine.yaml").write_text("name: mine\n")
    settings = RehearsalSettings(scenario="mine.yaml")
    with pytest.raises(ValueError, match=r"mine\.yaml; a rehearsal .*, three-lanes"):
        rehearse(tmp_path / "study", settings)
    assert not (tmp_path / "study").exists()


def test_a_rehearsal_that_stands_still_says_where_to_look(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(robot, "_PATIENCE", 0.0)
    monkeypatch.setattr(robot.Robot, "_went_on", lambda _: "practise-manual ready")
    stuck = robot.Robot(tmp_path, RehearsalSettings(accidents=0.0), None, print)
    with pytest.raises(ValueError, match=r"too busy or too slow.*rehearsal\.log"):
        stuck.take_part("R01")


class _Clock:
    """A clock that somebody sets."""

    now = 0.0

    def __call__(self) -> float:
        return self.now


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> _Clock:
    """What a rehearsal tells the time by."""
    found = _Clock()
    monkeypatch.setattr(robot.time, "monotonic", found)
    monkeypatch.setattr(robot.time, "sleep", lambda _: None)
    return found


def test_a_long_drive_on_a_busy_computer_does_not_stand_still(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, clock: _Clock
) -> None:
    """The car moves, however slowly; a car that has stopped stands still."""
    driver = robot.Robot(tmp_path, RehearsalSettings(accidents=0.0), None, print)
    metres = iter([10.0, 20.0, 30.0, 40.0, *[50.0] * 9])
    steps = []

    def ask(_: str) -> dict[str, object]:
        clock.now += 50.0
        drive = {"state": "running", "metres": next(metres)}
        steps.append({"id": "drive-manual", "kind": "drive", "drive": drive})
        return {"step": steps[-1], "trouble": ""}

    monkeypatch.setattr(driver, "_sit_down", lambda: None)
    monkeypatch.setattr(driver.server, "ask", ask)
    monkeypatch.setattr(driver, "_do", lambda *_: None)
    with pytest.raises(ValueError, match=r"R01 stands at drive-manual running 50 m"):
        driver.take_part("R01")
    assert len(steps) == 8  # four that moved, one that stopped, 150 s of patience


def test_time_in_which_the_server_compiles_is_no_standstill(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, clock: _Clock
) -> None:
    driver = robot.Robot(tmp_path, RehearsalSettings(accidents=0.0), None, print)
    is_there: list[bool] = []

    def start() -> None:
        clock.now += 300.0
        is_there.append(True)

    def ask(_: str) -> dict[str, object]:
        if len(is_there) < 3:
            is_there.append(True)
            raise TimeoutError  # the first answers take long
        return {"step": {"kind": "done"}, "trouble": ""}

    monkeypatch.setattr(RehearsalServer, "is_alive", property(lambda _: bool(is_there)))
    monkeypatch.setattr(driver.server, "start", start)
    monkeypatch.setattr(driver.server, "ask", ask)
    monkeypatch.setattr(driver.server, "console", lambda *_, **__: {"attempts": []})
    monkeypatch.setattr(driver, "_open_page", lambda: None)
    driver.take_part("R01")
    assert clock.now == 300.0


def test_a_drive_that_is_begun_again_and_again_is_given_up(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    driver = robot.Robot(tmp_path, RehearsalSettings(), None, print)
    rows = [{"reason": "the computer was too busy"}, {"reason": ""}]
    monkeypatch.setattr(driver.server, "console", lambda *_, **__: {"attempts": rows})
    step = {"id": "drive-manual", "attempt": 10}
    driver._refuse_endless(step)
    driver.accidents["loop"] = 1
    driver._refuse_endless(step | {"attempt": 11})
    with pytest.raises(ValueError, match="manual 12 times; the last time: the comp"):
        driver._refuse_endless(step | {"attempt": 12})


@pytest.mark.parametrize("length", [7, 99])
def test_an_answer_that_was_cut_off_is_none(tmp_path: Path, length: int) -> None:
    """The server was killed in the middle of one, with its length told or not kept."""

    class Killed(BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            self.send_response(200)
            self.send_header("Content-Length", str(length))
            self.end_headers()
            self.wfile.write(b'{"step"')

    with HTTPServer(("127.0.0.1", 0), Killed) as killed:
        threading.Thread(target=killed.handle_request).start()
        server = RehearsalServer(tmp_path, 1.0)
        server.address = f"http://127.0.0.1:{killed.server_port}"
        with pytest.raises(OSError, match="api/session was cut off"):
            server.ask("/api/session")


@pytest.mark.browser
@pytest.mark.slow
@pytest.mark.timeout(1200)
def test_whatever_is_killed_no_answer_and_no_finished_drive_is_lost(
    tmp_path: Path,
) -> None:
    pytest.importorskip("playwright")
    said: list[str] = []
    settings = RehearsalSettings(
        participants=1,
        seed=3,
        accidents=4.0,
        length=150.0,
        conditions=("strong-rapid",),
    )
    found = rehearse(tmp_path / "study", settings, said.append)
    assert found.participants == 1, said
    assert (found.lost_answers, found.lost_trials) == (0, 0), said
    assert found.trials == 4  # practice and trial, manual and with guidance
    assert found.answers > 50
    assert found.waits, "the console was never asked while someone drove"
    assert 0.0 < found.waits[0] <= found.waits[-1]
    killed = [line for line in said if re.search("is killed", line)]
    assert len(killed) == sum(found.accidents.values())


@pytest.mark.browser
@pytest.mark.slow
@pytest.mark.timeout(1200)
def test_drives_that_end_with_a_collision_come_to_an_end(tmp_path: Path) -> None:
    """Virtual hands keep their speed: they meet the car that cuts in and brakes."""
    pytest.importorskip("playwright")
    settings = RehearsalSettings(
        participants=1,
        accidents=0.0,
        length=3000.0,
        conditions=("strong-normal",),
        scenario="cut-in",
    )
    said: list[str] = []
    found = rehearse(tmp_path / "study", settings, said.append)
    assert (found.participants, found.trials) == (1, 4), said
    assert (found.lost_answers, found.lost_trials) == (0, 0), said
    session = Session(tmp_path / "study")
    reasons = [row["reason"] for row in Attempts(session).listed()]
    session.close()
    assert "it ended with a collision" in reasons
