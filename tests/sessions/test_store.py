"""The store of a study that is damaged or gone: told, and nothing is written over."""

from __future__ import annotations

from pathlib import Path

import pytest

from costeer.cli import main
from costeer.sessions.attempts import Attempts
from costeer.sessions.session import Session
from costeer.sessions.store import STORE_FILE, Store

PLAN = "title: a\nlength: 200\nsteps: [{kind: drive, condition: manual}]\n"


@pytest.fixture
def driven(tmp_path: Path) -> Path:
    """The folder of a study in which P01 has finished a drive."""
    (tmp_path / "plan.yaml").write_text(PLAN)
    session = Session(tmp_path)
    session.begin("P01")
    attempts = Attempts(session)
    number, record = attempts.start("P01", "drive-manual", {})
    record.write_bytes(b"what was driven")
    attempts.end("P01", "drive-manual", number, {})
    session.close()
    return tmp_path


@pytest.mark.parametrize("is_empty", [True, False])
def test_a_study_whose_store_is_gone_is_not_begun_anew(
    driven: Path, is_empty: bool, capsys: pytest.CaptureFixture[str]
) -> None:
    (driven / STORE_FILE).unlink()
    if is_empty:
        (driven / STORE_FILE).touch()
    assert main(["session", "status", str(driven)]) == 2
    (told,) = capsys.readouterr().err.splitlines()
    assert "session.sqlite is" in told
    assert "1 drive lies in the folder" in told
    assert "put a copy of it back" in told
    assert is_empty == (driven / STORE_FILE).exists()


def test_a_drive_never_takes_the_name_of_a_file_that_is_there(driven: Path) -> None:
    session = Session(driven)
    session.begin("P02")
    step = session.standing("P02").step
    for suffix in ("", "-2"):
        stray = driven / f"records/P02-drive-manual{suffix}.parquet"
        stray.write_bytes(b"of another computer")
    number, record = Attempts(session).next("P02", step)
    session.close()
    assert (number, record.name) == (3, "P02-drive-manual-3.parquet")


def test_a_store_that_is_damaged_inside_is_refused_with_the_way_out(
    tmp_path: Path,
) -> None:
    path = tmp_path / STORE_FILE
    store = Store(path)
    with store.transaction():
        for _ in range(400):
            store.tell("note", "x" * 100)
    store.close()
    whole = path.read_bytes()
    page = 4096  # the first has the tables; those behind it have the rows
    path.write_bytes(whole[: 5 * page] + bytes(page) + whole[6 * page :])
    with pytest.raises(ValueError, match=r"damaged: .*put a copy of it back"):
        Store(path)
    path.write_bytes(whole)
    Store(path).close()
