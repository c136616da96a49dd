"""`costeer replay` serves a record until it is stopped, and refuses in one line."""

from __future__ import annotations

import json
import os
import re
import signal
import subprocess
import sys
import urllib.request
from pathlib import Path

import pytest

from costeer.cli import main
from costeer.records.record import write_record
from tests.study.synthetic import synthetic_record
from tests.waiting import PATIENCE


@pytest.fixture(scope="module")
def trial(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("record") / "trial.parquet"
    write_record(path, synthetic_record("weak-normal", length=300.0))
    return path


@pytest.mark.slow
@pytest.mark.skipif(os.name != "posix", reason="signals another process by SIGINT")
def test_it_prints_the_address_answers_and_stops_at_ctrl_c(trial: Path) -> None:
    words = [sys.executable, "-m", "costeer", "replay", str(trial)]
    options = ["--port", "0", "--no-browser"]
    with subprocess.Popen(
        [*words, *options], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as process:
        assert process.stdout is not None
        line = process.stdout.readline()
        found = re.search(r"http://127\.0\.0\.1:\d+/", line)
        assert found, line
        with urllib.request.urlopen(f"{found[0]}api/hello", timeout=PATIENCE) as answer:
            hello = json.load(answer)
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate(timeout=PATIENCE)
    assert (hello["mode"], hello["title"]) == ("replay", "trial.parquet")
    assert process.returncode == 130
    assert errors == "costeer: stopped\n"


def test_what_cannot_be_shown_is_told_in_one_line(
    trial: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    table = tmp_path / "table.csv"
    table.write_text("time,lateral_position\n0,0\n1,0\n")
    wrong = {
        f"{table}: there is no column longitudinal_position, yaw_angle": [str(table)],
        "a replay needs time, longitudinal_position": [str(table)],
        "check the path": [str(tmp_path / "no.parquet")],
        "port is 70000; give one from 1 to 65535": [str(trial), "--port", "70000"],
        "no address of this computer": [str(trial), "--host", "203.0.113.7"],
    }
    for told, words in wrong.items():
        assert main(["replay", "--no-browser", *words]) == 2
        shown = capsys.readouterr().err
        assert told in shown
        assert shown.count("\n") == 1
