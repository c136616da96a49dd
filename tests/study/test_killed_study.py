"""A study survives the death of its process, and Ctrl-C, at any moment."""

from __future__ import annotations

import signal
import subprocess
import sys
from pathlib import Path

import pytest

from tests.study.fakes import NUM_TRIALS, contents, run_small
from tests.waiting import PATIENCE, wait_for

ROOT = Path(__file__).parents[2]

KILLED = """
import os, signal, sys
from pathlib import Path
from costeer.study.run import run_study
from tests.study.fakes import SMALL, made_up

out = Path(sys.argv[1])
count = 0

def simulate(setup):
    global count
    count += 1
    if count == 3:
        (out / "records" / "01-weak-gentle.parquet.tmp").write_bytes(b"PAR1 half")
        os.kill(os.getpid(), signal.SIGKILL)
    return made_up(setup)

run_study(out, SMALL, jobs=1, simulate=simulate)
"""

SLOW = """
import sys, time
from functools import partial
from pathlib import Path
from costeer.cli import main
from costeer.study import run
from tests.study.fakes import made_up, plain_report

count = 0

def slow(setup):
    # The second trial runs until Ctrl-C has been pressed.
    global count
    count += 1
    while count == 2 and not Path(sys.argv[2]).exists():
        time.sleep(0.01)
    time.sleep(1.0 if count > 2 else 0.0)
    return made_up(setup)

run.full_report = plain_report
run.run_study = partial(run.run_study, simulate=slow)
sys.exit(main(["study", "--out", sys.argv[1], "--participants", "2", "--conditions",
    "manual,strong-rapid,weak-gentle", "--intention", "scripted", "--length", "1800",
    "--jobs", "1"]))
"""


def command(script: str, out: Path) -> list[str]:
    return [sys.executable, "-c", script, str(out)]


@pytest.mark.slow
def test_a_killed_study_goes_on_where_it_was(tmp_path: Path) -> None:
    out, whole = tmp_path / "out", tmp_path / "whole"
    died = subprocess.run(command(KILLED, out), cwd=ROOT, check=False)
    assert died.returncode == -signal.SIGKILL
    assert list(out.rglob("*.tmp"))
    assert run_small(out).num_resumed == 2
    run_small(whole)
    assert contents(out) == contents(whole)


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="no SIGINT for one process there")
def test_ctrl_c_ends_with_130_and_says_how_to_resume(tmp_path: Path) -> None:
    out, whole = tmp_path / "out", tmp_path / "whole"
    pressed = tmp_path / "pressed"
    process = subprocess.Popen(
        [*command(SLOW, out), str(pressed)],
        cwd=ROOT,
        stderr=subprocess.PIPE,
        text=True,
    )
    wait_for((out / "records" / "01-manual.parquet").exists)
    process.send_signal(signal.SIGINT)
    pressed.touch()
    _, said = process.communicate(timeout=PATIENCE)
    assert process.returncode == 130
    assert "of 6 trials are done and kept in" in said
    assert "run the same command again" in said
    assert "Traceback" not in said
    assert 1 <= run_small(out).num_resumed < NUM_TRIALS
    run_small(whole)
    assert contents(out) == contents(whole)
