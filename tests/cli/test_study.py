"""`costeer study` runs, resumes and refuses in one line."""

from __future__ import annotations

import sys
from functools import partial
from pathlib import Path

import pytest

from costeer.cli import main
from costeer.cli.trial_progress import speedometer, study_progress
from costeer.loop.scenario import TrialSetup
from costeer.records.record import TrialRecord
from costeer.study import run
from costeer.study.design import Trial
from costeer.study.trial_tables import TrialRows
from costeer.study.trials import TrialDone
from tests.study.fakes import contents, made_up, plain_report

QUICK = ("--participants", "1", "--conditions", "manual,weak-gentle", "--length")
OPTIONS = [*QUICK, "1800", "--intention", "scripted"]


@pytest.fixture
def _fake(monkeypatch: pytest.MonkeyPatch) -> None:
    """Made-up trials instead of simulated ones, a plain report."""
    monkeypatch.setattr(run, "full_report", plain_report)
    monkeypatch.setattr(run, "run_study", partial(run.run_study, simulate=made_up))


def done(seconds: float, resumed: bool = False) -> TrialDone:
    return TrialDone(Trial(1, "manual", 1), TrialRows({}, []), seconds, resumed)


@pytest.mark.usefixtures("_fake")
def test_a_study_ends_with_its_report(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "study"
    assert main(["study", "--out", str(out), *OPTIONS]) == 0
    shown = capsys.readouterr()
    assert "2 trials simulated, 0 were there" in shown.out
    assert shown.out.endswith(f"{out / 'report.html'}\n")
    assert "trials: 2 of 2" in shown.err
    assert shown.err.endswith("report: plain\n")


@pytest.mark.usefixtures("_fake")
def test_without_a_report_the_tables_are_the_end(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ["study", "--out", str(tmp_path), *OPTIONS, "--no-report"]
    assert main(words) == 0
    assert capsys.readouterr().out.endswith("trials.csv\n")
    assert "report.html" not in contents(tmp_path)


@pytest.mark.usefixtures("_fake")
def test_the_same_command_again_simulates_nothing(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ["study", "--out", str(tmp_path), *OPTIONS]
    main(words)
    before = contents(tmp_path)
    assert main(words) == 0
    assert "0 trials simulated, 2 were there" in capsys.readouterr().out
    assert contents(tmp_path) == before


@pytest.mark.usefixtures("_fake")
def test_a_speed_may_have_its_unit(tmp_path: Path) -> None:
    words = ["study", "--out", str(tmp_path), *OPTIONS, "--speed", "72km/h"]
    assert main(words) == 0
    assert "speed: 20.0" in (tmp_path / "study.yaml").read_text(encoding="utf-8")


def test_an_order_that_never_came_is_told_with_how_often(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    actor = (
        "{name: ahead, at: 200, speed: 78 km/h, orders: [{when: {gap: 20}, lane: 1}]}"
    )
    file = tmp_path / "late.yaml"
    file.write_text(f"name: late\nspeed: 80 km/h\nactors:\n  - {actor}\n")
    given = ["study", "--scenario", str(file), *QUICK, "200", "--no-report"]
    assert main([*given, "--intention", "scripted", "--out", str(tmp_path / "a")]) == 0
    told = "in 2 of 2 drives: ahead never got its order (lane 1)"
    assert told in capsys.readouterr().err


@pytest.mark.usefixtures("_fake")
def test_too_few_participants_for_the_square_are_told(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ["study", "--out", str(tmp_path), *OPTIONS]
    words[words.index("manual,weak-gentle")] = "manual,strong-rapid,weak-gentle"
    assert main(words) == 0
    assert "not balanced; give a multiple of 2" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--participants", "0"], "participants is 0; give a whole number 1 to"),
        (["--participants", "many"], "Invalid value for '--participants'"),
        (["--conditions", "strong-fast"], "unknown condition 'strong-fast'"),
        (["--conditions", "manual,manual"], "condition manual is given twice"),
        (["--method", "magic"], "method 'magic' is not known"),
        (["--intention", "off"], "intention 'off' is not known"),
        (["--speed", "nan"], "speed is nan"),
        (["--speed", "70"], "speed is 70"),
        (["--speed", "fast"], "give metres per second, as 19.4, or 70km/h"),
        (["--length", "inf"], "length is inf"),
        (["--seed", "-1"], "seed is -1"),
        (["--jobs", "0"], "jobs is 0"),
        (["--cluster", "mars"], "cluster 'mars' is not known; give local:N"),
        (["--cluster", "local:2", "--jobs", "2"], "all workers of a cluster work"),
        (["--shard", "3/2"], "shard 3/2: the first number is 1 to 2"),
        (["--shard", "slurm"], "needs SLURM_ARRAY_TASK_ID"),
        (["--car", "lorry"], "car 'lorry' is not known"),
    ],
)
def test_a_wrong_option_is_refused(
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    options: list[str],
    message: str,
) -> None:
    out = tmp_path / "none"
    words = ["study", "--out", str(out), "--intention", "scripted", *options]
    assert main(words) == 2
    said = capsys.readouterr().err.splitlines()
    assert len(said) == 1
    assert message in said[0]
    assert not out.exists()


@pytest.mark.usefixtures("_fake")
def test_shards_end_with_how_to_merge_them(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ["study", "--out", str(tmp_path / "study"), *OPTIONS]
    for shard in ("1/2", "2/2"):
        assert main([*words, "--shard", shard, "--no-records"]) == 0
        told = capsys.readouterr()
        assert "1 trials simulated, 0 were there" in told.out
        assert f"shard {shard} is done; when all are: costeer merge" in told.err
    assert main(["merge", str(tmp_path / "study"), "--no-report"]) == 0
    whole = ["study", "--out", str(tmp_path / "whole"), *OPTIONS, "--no-report"]
    assert main(whole) == 0
    shards, whole_study = contents(tmp_path / "study"), contents(tmp_path / "whole")
    assert shards["trials.csv"] == whole_study["trials.csv"]


def test_a_study_with_a_failed_trial_ends_with_1(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    def failing(setup: TrialSetup) -> TrialRecord:
        if setup.condition == "manual":
            raise ValueError("the road ends")
        return made_up(setup)

    monkeypatch.setattr(run, "run_study", partial(run.run_study, simulate=failing))
    words = ["study", "--out", str(tmp_path), *OPTIONS, "--no-report"]
    assert main(words) == 1
    told = capsys.readouterr()
    assert "1 trials simulated, 0 were there" in told.out
    assert (
        "1 of 2 trials failed: participant 1, manual: the road ends; the same command "
        "tries them again"
    ) in told.err


def test_a_file_as_folder_is_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "out").write_text("mine")
    assert main(["study", "--out", str(tmp_path / "out"), *OPTIONS]) == 2
    assert "is a file; give a new or empty folder" in capsys.readouterr().err
    assert (tmp_path / "out").read_text() == "mine"


def test_an_interruption_is_130_and_says_how_to_resume(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    def interrupted(*_: object, **__: object) -> None:
        raise run.StudyInterrupted("1 of 2 trials are done")

    monkeypatch.setattr(run, "run_study", interrupted)
    assert main(["study", "--out", str(tmp_path), *OPTIONS]) == 130
    said = capsys.readouterr().err.splitlines()
    assert said[0] == "costeer: 1 of 2 trials are done"


def test_resumed_trials_are_not_speed() -> None:
    times = iter([0.0, 1.0, 2.0])
    rate = speedometer(clock=lambda: next(times))
    assert rate(done(400.0, resumed=True)) == ""
    assert rate(done(4000.0)) == "2,000 driver-s/s"


def test_a_terminal_sees_trials_and_speed(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("COLUMNS", "120")
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    with study_progress(2) as display:
        display.trial(done(400.0))
        display.trial(done(400.0))
        display.step("figures")
    shown = capsys.readouterr()
    assert shown.out == ""
    assert "2/2" in shown.err
    assert "report: figures" in shown.err


def test_two_real_trials_are_the_same_in_any_number_of_jobs(tmp_path: Path) -> None:
    folders = [tmp_path / "one", tmp_path / "two"]
    for jobs, folder in enumerate(folders, start=1):
        words = ["study", "--out", str(folder), "--no-report", "--jobs", str(jobs)]
        assert main([*words, *QUICK, "400", "--intention", "scripted"]) == 0
    one, two = map(contents, folders)
    assert one == two
    assert len(one) == 6
