"""A session stands where the store says, whatever happened to the process."""

from __future__ import annotations

import sqlite3
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from costeer.devices.head.calibration import HeadCalibration, save_calibration
from costeer.devices.head.source import HeadDescription
from costeer.sessions.attempts import ABORTED, RUNNING, Attempts
from costeer.sessions.balance import balance
from costeer.sessions.plan import block_order, session_steps
from costeer.sessions.plan_file import paper_plan_text, parsed_plan
from costeer.sessions.session import Session
from costeer.sessions.standing import FINISHED, WHOLE, OutOfStepError
from costeer.sessions.store import STORE_FILE, StoreError
from costeer.sessions.withdrawal import files_of, num_withdrawn, withdraw
from tests.sessions.made_up import rows_of

SHORT = """
title: Short
participants: 2
length: 200
steps:
  - {kind: consent, instrument: consent}
  - {kind: practise, condition: manual, minutes: 1, longest_minutes: 2}
  - {kind: drive, condition: manual}
  - kind: trials
    conditions: [strong-rapid, weak-gentle]
    break_every: 1
    minutes: 1
    after: [{kind: ask, instrument: nasa-tlx}]
"""
IDS = [
    "consent",
    "practise-manual",
    "drive-manual",
    "drive-strong-rapid",
    "ask-nasa-tlx-strong-rapid",
    "break",
    "drive-weak-gentle",
    "ask-nasa-tlx-weak-gentle",
]


def study(folder: Path, plan: str = SHORT) -> Session:
    """A session in a folder; opened again if there is one."""
    if not (folder / "plan.yaml").exists():
        (folder / "plan.yaml").write_text(plan)
    return Session(folder)


def drive(session: Session, who: str, step: str) -> Path:
    """Drive a step to its end."""
    attempts = Attempts(session)
    number, record = attempts.start(who, step, {"wheel": "simulated"})
    record.write_bytes(b"record")
    attempts.end(who, step, number, {"sdlp": 0.2})
    return record


def answer(session: Session, who: str, step: str) -> None:
    session.answer(who, step, {"effort": 55, "mental": 5}, ("nasa-tlx", "1"))


def go_on(session: Session, who: str) -> str:
    """Do what comes next; return the step that was on."""
    step = session.standing(who).step
    if step.kind in ("practise", "drive"):
        drive(session, who, step.id)
    elif step.kind in ("ask", "consent"):
        answer(session, who, step.id)
    else:
        session.finish(who, step.id)
    return step.id


def test_the_steps_come_in_the_order_of_the_plan_and_end(tmp_path: Path) -> None:
    session = study(tmp_path)
    session.begin("P01")
    assert [go_on(session, "P01") for _ in IDS] == IDS
    standing = session.standing("P01")
    assert (standing.step.kind, standing.of) == ("done", len(IDS))
    assert session.people()[0]["status"] == FINISHED
    assert (tmp_path / "records/P01-drive-manual.parquet").is_file()
    assert (tmp_path / "practice/P01-practise-manual.parquet").is_file()


@pytest.mark.slow
@settings(
    max_examples=25,
    deadline=None,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)
@given(
    deaths=st.lists(st.integers(0, 40), max_size=6),
    half_done=st.lists(st.booleans(), min_size=41, max_size=41),
)
def test_whatever_dies_no_answer_and_no_finished_drive_is_lost(
    tmp_path_factory: pytest.TempPathFactory, deaths: list[int], half_done: list[bool]
) -> None:
    """The process dies between any two steps, or in the middle of a drive."""
    folder = tmp_path_factory.mktemp("study")
    session = study(folder)
    session.begin("P01")
    done: list[str] = []
    for turn in range(41):
        on = session.standing("P01").step
        if on.kind == "done":
            break
        if turn in deaths:
            if on.drives and half_done[turn]:
                _, record = Attempts(session).start("P01", on.id, {})
                record.with_suffix(".arrow").write_bytes(b"half")
            session.close()
            session = study(folder)
            Attempts(session)
            assert session.standing("P01").step.id == on.id
        done.append(go_on(session, "P01"))
    assert done == IDS
    rows = Attempts(session).listed("P01")
    assert sum(row["state"] == WHOLE for row in rows) == 4
    assert not [row for row in rows if row["state"] == RUNNING]
    for row in rows:
        if row["state"] == WHOLE:
            assert (folder / row["record"]).read_bytes() == b"record"
    told = session.store.rows("SELECT * FROM answers")
    assert len(told) == 2 * 3
    aborted = [row for row in rows if row["state"] == ABORTED]
    assert len(list((folder / "aborted").glob("*.arrow"))) == len(aborted)


def test_an_aborted_drive_is_driven_again_and_both_are_kept(tmp_path: Path) -> None:
    session = study(tmp_path)
    session.begin("P01")
    answer(session, "P01", "consent")
    attempts = Attempts(session)
    number, record = attempts.start("P01", "practise-manual", {})
    record.write_bytes(b"first")
    attempts.end("P01", "practise-manual", number, None, "the wheel was lost")
    assert session.standing("P01").step.id == "practise-manual"
    second, again = attempts.start("P01", "practise-manual", {})
    assert second == 2
    assert again != record
    again.write_bytes(b"second")
    attempts.end("P01", "practise-manual", second, {})
    first, last = attempts.listed("P01")
    assert (first["state"], first["reason"]) == (ABORTED, "the wheel was lost")
    assert (tmp_path / first["record"]).read_bytes() == b"first"
    assert (tmp_path / last["record"]).read_bytes() == b"second"


def test_answers_that_come_twice_are_one_and_others_are_refused(tmp_path: Path) -> None:
    session = study(tmp_path)
    session.begin("P01")
    answer(session, "P01", "consent")
    answer(session, "P01", "consent")
    assert len(session.store.rows("SELECT * FROM answers")) == 2
    with pytest.raises(OutOfStepError, match="answered before"):
        session.answer("P01", "consent", {"effort": 60}, ("nasa-tlx", "1"))
    with pytest.raises(OutOfStepError, match="'drive-manual' is not on"):
        Attempts(session).start("P01", "drive-manual", {})
    assert session.answers_of("P01", "consent") == {"effort": "55", "mental": "5"}


def test_a_dropout_is_replaced_in_the_same_row_of_the_square(tmp_path: Path) -> None:
    session = study(tmp_path)
    for who in ("P01", "P02", "P03"):
        session.begin(who)
    session.drop("P02", "felt sick")
    session.begin("P04")
    slots = {row["participant"]: row["slot"] for row in session.people()}
    assert (slots["P04"], slots["P03"]) == (slots["P02"], 3)
    second = [each.id for each in session.steps_of("P04")]
    assert second == [each.id for each in session.steps_of("P02")]
    with pytest.raises(ValueError, match="P02 has dropped out; give another"):
        session.begin("P02")
    with pytest.raises(ValueError, match="give a reason"):
        session.drop("P01", "  ")


def test_repeating_a_step_excludes_what_was_driven_and_asks_again(
    tmp_path: Path,
) -> None:
    session = study(tmp_path)
    session.begin("P01")
    for _ in IDS:
        go_on(session, "P01")
    session.repeat("P01", "drive-strong-rapid", "the projector went out")
    assert session.standing("P01").step.id == "drive-strong-rapid"
    rows = Attempts(session).listed("P01")
    (out,) = [row for row in rows if row["excluded"]]
    assert (out["step"], out["reason"]) == (
        "drive-strong-rapid",
        "the projector went out",
    )
    drive(session, "P01", "drive-strong-rapid")
    assert session.standing("P01").step.kind == "done"
    session.repeat("P01", "ask-nasa-tlx-strong-rapid", "pressed by mistake")
    assert session.answers_of("P01", "ask-nasa-tlx-strong-rapid") == {}


def test_withdrawal_deletes_rows_files_and_free_pages(tmp_path: Path) -> None:
    session = study(tmp_path)
    session.begin("P01")
    session.begin("P02")
    for _ in range(4):
        go_on(session, "P01")
        go_on(session, "P02")
    session.note("P01", "unusual words xylophone quartz")
    (tmp_path / "records/P01-drive-manual.arrow").write_bytes(b"stream")
    tracker = HeadDescription("opentrack", "")
    calibrated = [
        save_calibration(HeadCalibration(who, tracker)) for who in ("P01", "P02")
    ]
    files = len(files_of(session, "P01"))
    assert withdraw(session, "P01") == files == 5
    assert [file.exists() for file in calibrated] == [False, True]
    assert rows_of(session, "P01") == []
    assert num_withdrawn(session) == 1
    assert rows_of(session, "P02") != []
    session.close()
    assert b"xylophone" not in (tmp_path / STORE_FILE).read_bytes()
    for other in tmp_path.glob(f"{STORE_FILE}-*"):
        assert b"xylophone" not in other.read_bytes()
    assert not [*tmp_path.rglob("P01-*")]
    assert len([*tmp_path.rglob("P02-*")]) == 3


def test_who_has_begun_keeps_the_plan_they_began_with(tmp_path: Path) -> None:
    session = study(tmp_path)
    session.begin("P01")
    session.close()
    changed = SHORT.replace("length: 200", "length: 300").replace(
        "[strong-rapid, weak-gentle]", "[strong-rapid, weak-rapid]"
    )
    (tmp_path / "plan.yaml").write_text(changed)
    again = study(tmp_path)
    assert again.plan_version == 2
    assert again.plan_of("P01").length == 200.0
    again.begin("P02")
    assert again.plan_of("P02").length == 300.0
    assert "drive-weak-rapid" in [each.id for each in again.steps_of("P02")]
    assert "drive-weak-rapid" not in [each.id for each in again.steps_of("P01")]
    again.close()
    (tmp_path / "plan.yaml").write_text(f"# only a remark\n{changed}")
    assert study(tmp_path).plan_version == 2


@pytest.mark.parametrize("name", ["", "Anna", "P 1", "anna@lab.org", "P01'", "P123456"])
def test_names_are_refused_as_pseudonyms(tmp_path: Path, name: str) -> None:
    with pytest.raises(ValueError, match="give a pseudonym"):
        study(tmp_path).begin(name)


def test_a_full_disk_changes_nothing_and_says_so(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    session = study(tmp_path)
    session.begin("P01")

    class Full:
        """A file whose disk is full."""

        def __init__(self, file: Any) -> None:
            self._file = file

        def __getattr__(self, name: str) -> Any:
            return getattr(self._file, name)

        def execute(self, command: str, *rest: Any) -> Any:
            if command.startswith("INSERT"):
                raise sqlite3.OperationalError("database or disk is full")
            return self._file.execute(command, *rest)

    with monkeypatch.context() as patch:
        patch.setattr(session.store, "_file", Full(session.store._file))
        with pytest.raises(StoreError, match="disk is full; nothing was lost"):
            answer(session, "P01", "consent")
    assert session.standing("P01").step.id == "consent"
    answer(session, "P01", "consent")
    assert session.standing("P01").step.id == "practise-manual"


def test_a_file_of_something_else_is_no_store(tmp_path: Path) -> None:
    (tmp_path / STORE_FILE).write_bytes(b"something else" * 100)
    with pytest.raises(ValueError, match="no store of a study"):
        study(tmp_path)


def test_the_papers_plan_is_balanced_over_twelve() -> None:
    plan = parsed_plan(paper_plan_text())
    assert balance(plan, range(1, 13)).is_even
    assert not balance(plan, range(1, 12)).is_even
    counts = balance(plan, [*range(1, 12), 12, 3])
    assert not counts.is_even
    steps = session_steps(plan, 5)
    trials = [each.condition for each in steps if each.kind == "drive"]
    assert trials[0] == "manual"
    assert len(set(trials)) == len(trials) == 7
    assert [each.order for each in steps if each.kind == "drive"] == list(range(1, 8))
    asked = [each.condition for each in steps if each.instrument == "nasa-tlx"]
    assert asked == trials


def test_a_random_order_is_the_same_again_and_differs_between_people() -> None:
    plan = parsed_plan(paper_plan_text().replace("order: williams", "order: random"))
    block = next(each for each in plan.steps if each.kind == "trials")
    orders = [block_order(block, slot, 1) for slot in range(1, 9)]
    assert orders == [block_order(block, slot, 1) for slot in range(1, 9)]
    assert len(set(orders)) > 4
    assert all(sorted(order) == sorted(block.conditions) for order in orders)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("title: a\nstep: []", r"line 2: step is not known \(did you mean steps"),
        ("title: a\nsteps: []", "has no steps"),
        ("steps: [{kind: consent, instrument: x}]", "lacks title"),
        ("title: a\nsteps: [{kind: drve}]", "'drve' is none of instruct"),
        ("title: a\nsteps: [{kind: ask}]", "names no instrument"),
        ("title: a\nsteps: [{kind: drive, condition: strog-rapid}]", "did you mean"),
        ("title: a\nsteps: [{kind: practise, condition: manual}]", "minutes is nan"),
        ("title: a\nsteps: [{kind: trials}]", "name each once"),
        ("title: a\nseed: 1.5\nsteps: []", "line 2: seed is 1.5; give a whole number"),
        ("title: a\ntitle: b\nsteps: []", "line 2: title stands twice"),
        ("title: a\nlength: 5\nsteps: [{kind: drive, condition: manual}]", "length"),
        ("[1, 2]", "is no list of names and values"),
        ("title: [", "is not YAML"),
    ],
)
def test_a_plan_that_cannot_be_is_refused_with_the_line(text: str, said: str) -> None:
    with pytest.raises(ValueError, match=said):
        parsed_plan(text)
