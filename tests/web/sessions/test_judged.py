"""Which drives of a session are whole: at the end of the course, or at a collision."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from costeer.records.columns import TrialRecord
from costeer.records.record import write_record
from costeer.runtime.markers import Marker
from costeer.runtime.states import Fault
from costeer.sessions.plan import Step
from costeer.sessions.session import Session
from costeer.web.sessions import judged
from costeer.web.sessions.desk import Desk
from costeer.web.sessions.devices import Devices
from costeer.web.sessions.judged import LiveCriterion, driven_whole, measured
from costeer.web.sessions.step_drive import Outcome, StepDrive
from tests.study.synthetic import synthetic_record

TRIAL = Step("drive-manual", "drive", condition="manual", order=1)
PRACTICE = Step("practise-manual", "practise", condition="manual", minutes=0.5)


def kept(folder: Path, seconds: float = math.inf, ended: str = "course") -> Path:
    """A drive that was ended after some seconds; SDLP of its lane keeping: 0.2 m."""
    whole = synthetic_record("manual", 1, length=1800.0)
    rows = whole.columns["time"] <= seconds
    columns = {name: values[rows] for name, values in whole.columns.items()}
    markers = [{"kind": "ended", "name": ended, "time": float(columns["time"][-1])}]
    road = {"road": {"length": 1800.0}}
    metadata = {**whole.metadata, "markers": markers, "configuration": road}
    file = folder / "drive.parquet"
    write_record(file, whole._replace(columns=columns, metadata=metadata))
    return file


def test_trial_that_ends_with_a_collision_is_whole(tmp_path: Path) -> None:
    measures, told = measured(kept(tmp_path, 20.0, "collision"), TRIAL)
    assert measures is not None
    assert measures["duration"] == pytest.approx(20.0, abs=0.1)
    assert "collision" in told


@pytest.mark.parametrize(
    ("ended", "is_whole"), [("collision", True), ("server", False)]
)
def test_drive_cut_short_is_whole_only_if_it_hit_something(
    tmp_path: Path, ended: str, is_whole: bool
) -> None:
    """The server was killed just after it: the record alone tells."""
    found = driven_whole(kept(tmp_path, 20.0, ended), TRIAL)
    assert (found is not None) == is_whole


@pytest.mark.parametrize(("seconds", "counts"), [(20.0, False), (40.0, True)])
def test_practice_that_hits_something_counts_once_it_was_long_enough(
    tmp_path: Path, seconds: float, counts: bool
) -> None:
    measures, told = measured(kept(tmp_path, seconds, "collision"), PRACTICE)
    assert (measures is not None) == counts
    assert ("practise again" in told) != counts


def test_criterion_is_judged_at_the_end_but_not_against_who_ended_it(
    tmp_path: Path,
) -> None:
    file = kept(tmp_path)
    sdlp = measured(file, PRACTICE)[0]["sdlp"]  # type: ignore[index]  # it has one
    strict = PRACTICE._replace(sdlp_below=0.5 * sdlp)
    measures, told = measured(file, strict)
    assert measures is None
    assert f"not below {0.5 * sdlp:g} m: practise again" in told
    measures, told = measured(file, strict, is_waived=True)
    assert measures is not None
    assert told == f"SDLP {sdlp:.2f} m, not below {0.5 * sdlp:g} m"


def test_criterion_is_looked_at_while_somebody_drives(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    now = [0.0]
    seen: list[Path] = []

    def read(path: Path) -> TrialRecord:
        seen.append(path)
        if len(seen) == 1:
            raise OSError("nothing is written yet")
        return synthetic_record("manual", 1, length=1800.0)

    monkeypatch.setattr(judged, "read_stream", read)
    stream = tmp_path / "drive.arrow"
    criterion = LiveCriterion(PRACTICE._replace(sdlp_below=5.0), stream, lambda: now[0])

    def look() -> dict[str, object]:
        criterion.told()
        if criterion._thread is not None:
            criterion._thread.join()
        return criterion.told()

    assert look() == {"sdlp": None, "below": 5.0, "met": False}
    assert seen == [stream]
    now[0] += judged.LOOK_EVERY
    told = look()
    assert told["met"] is True
    assert len(seen) == 2  # not at every question of the pages


class Practised:
    """A practice that was long enough."""

    seconds = 60.0

    def __init__(self) -> None:
        self.ended: list[tuple[object, ...]] = []

    def end(self, *how: object) -> None:
        """Remember how it was ended."""
        self.ended.append(how)


def test_participant_ends_a_practice_only_when_its_criterion_is_met(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "plan.yaml").write_text(
        "title: P\nsteps: [{kind: practise, condition: manual, minutes: 0.5, "
        "longest_minutes: 1, sdlp_below: 0.3}]\n"
    )
    desk = Desk(Session(tmp_path), Devices())
    desk.session.begin("P01")
    desk.participant = "P01"
    drive = Practised()
    monkeypatch.setattr(desk, "_prepare", lambda standing: None)
    monkeypatch.setattr(desk._shown, "shown", lambda *given: {})
    desk._drive = drive  # type: ignore[assignment]
    step = desk.session.standing("P01").step
    desk.criterion = LiveCriterion(step, tmp_path / "drive.arrow")
    for sdlp in (None, 0.31):
        desk.criterion.sdlp = sdlp
        with pytest.raises(ValueError, match="practise until"):
            desk.next("P01", step.id)
    desk.criterion.sdlp = 0.29
    desk.next("P01", step.id)
    assert drive.ended == [(True, "", True)]  # and is not judged again
    desk._drive = None
    desk.close()


@pytest.mark.parametrize("ended", ["course", "collision", "server"])
def test_attempt_ends_at_the_end_of_the_course_and_at_a_collision(ended: str) -> None:
    outcomes: list[Outcome] = []
    drive = StepDrive.__new__(StepDrive)
    drive.markers = []
    drive.end = lambda *how: outcomes.append(how)  # type: ignore[method-assign,assignment]
    drive._hear(Marker("ended", ended))
    assert [how[0] for how in outcomes] == ([] if ended == "server" else [True])


def test_what_was_wrong_is_told_until_it_is_mended() -> None:
    drive = StepDrive.__new__(StepDrive)
    drive.markers = []
    drive._hear(Marker("fault", Fault.WHEEL_LOST.word))
    assert drive.reason == Fault.WHEEL_LOST.text
    drive._hear(Marker("fault", Fault.ACKNOWLEDGED.word))
    assert drive.reason == ""


def test_drives_that_break_before_anybody_drives_are_not_begun_for_ever(
    tmp_path: Path,
) -> None:
    (tmp_path / "plan.yaml").write_text(
        "title: P\nsteps: [{kind: drive, condition: manual}]\n"
    )
    desk = Desk(Session(tmp_path), Devices())

    class Lame:
        state = "ended"

        def __init__(self, broke: bool) -> None:
            self.broke_unstarted = broke

    def ended(broke: bool) -> str:
        desk._drive = Lame(broke)  # type: ignore[assignment]
        with desk.lock:
            desk._forget_drive(Outcome(None, False, "the loop is gone", ()))
        return desk.trouble

    assert [ended(broke) for broke in (True, True, False, True, True)] == [""] * 5
    assert ended(True) == "the loop is gone"
    desk.close()
