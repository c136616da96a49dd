"""An error is one line on stderr and an exit code, never a traceback."""

from __future__ import annotations

import errno
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
import typer

from costeer.__main__ import run
from costeer.cli import main
from costeer.cli.errors import exit_code_of


def raising(error: BaseException) -> Callable[[], object]:
    """A command that raises."""

    def run() -> object:
        raise error

    return run


def test_success_is_0() -> None:
    assert exit_code_of(lambda: None) == 0


def test_exit_code_of_a_command_is_handed_on() -> None:
    assert exit_code_of(lambda: 1) == 1


@pytest.mark.parametrize(
    ("error", "said"),
    [
        (
            ValueError("speed 0 m/s is too low;\n give 5 to 60"),
            "speed 0 m/s is too low",
        ),
        (
            FileNotFoundError(errno.ENOENT, "no", "a.parquet"),
            "a.parquet: no; check the",
        ),
        (FileNotFoundError("a.parquet"), "a.parquet: No such file or directory; check"),
        (FileNotFoundError("no records; give a folder"), "no records; give a folder\n"),
        (OSError(errno.EIO, "Error writing bytes"), "costeer: Error writing bytes\n"),
        (OSError("not a Parquet file"), "not a Parquet file"),
        (
            OSError(errno.ENOSPC, "x", "out/a"),
            "free some space and run the same command",
        ),
        (PermissionError(errno.EACCES, "x", "out"), "choose a place"),
        (FileExistsError(errno.EEXIST, "x", "s/figures"), "in the way: move it"),
        (ValueError("row 1 is '\x1b[2J\x00'"), "row 1 is '?[2J?'\n"),
        (ModuleNotFoundError("x", name="optax"), "[train]'"),
        (ValueError(), "ValueError"),
    ],
)
def test_bad_input_is_one_line_and_2(
    error: Exception, said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert exit_code_of(raising(error)) == 2
    shown = capsys.readouterr()
    assert shown.out == ""
    assert shown.err.count("\n") == 1
    assert shown.err.startswith("costeer: ")
    assert said in shown.err


@pytest.mark.parametrize("error", [KeyboardInterrupt(), typer.Abort()])
def test_interruption_is_130(
    error: BaseException, capsys: pytest.CaptureFixture[str]
) -> None:
    assert exit_code_of(raising(error)) == 130
    assert capsys.readouterr().err == "costeer: stopped\n"


def test_interruption_inside_a_command_is_130(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(
        "costeer.doctor.examine", lambda _: raising(KeyboardInterrupt())()
    )
    assert main(["doctor"]) == 130
    assert capsys.readouterr().err == "costeer: stopped\n"


@pytest.mark.parametrize(
    ("error", "named"),
    [
        (ZeroDivisionError("by zero"), "ZeroDivisionError: by zero"),
        (KeyError("kind"), "KeyError: 'kind'"),
        (RecursionError("too deep"), "RecursionError: too deep"),
        (OverflowError("too large"), "OverflowError: too large"),
        (ModuleNotFoundError("x", name="costeer.nothing"), "ModuleNotFoundError: x"),
    ],
)
def test_a_mistake_of_costeer_is_one_line_70_and_a_file_to_send(
    error: Exception,
    named: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    monkeypatch.setattr("sys.argv", ["costeer", "study", "--out", "x"])
    assert exit_code_of(raising(error)) == 70
    (line,) = capsys.readouterr().err.splitlines()
    (file,) = tmp_path.iterdir()
    assert f"a mistake in costeer, not in your input: {named}; please send" in line
    assert line.endswith(str(file))
    sent = file.read_text("utf-8")
    assert sent.startswith("costeer study --out x\n")
    assert "Traceback" in sent
    assert named in sent


def test_where_no_file_can_be_written_the_option_is_named(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def full(**_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("tempfile.mkstemp", full)
    assert exit_code_of(raising(KeyError("kind"))) == 70
    assert "with --debug and send what it prints" in capsys.readouterr().err


def test_too_little_memory_is_told(capsys: pytest.CaptureFixture[str]) -> None:
    assert exit_code_of(raising(MemoryError())) == 2
    assert "not enough memory" in capsys.readouterr().err


@pytest.mark.parametrize("words", [["--debug", "report"], ["report", "--debug"]])
def test_debug_shows_the_traceback_wherever_it_stands(
    words: list[str],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.setenv("COSTEER_TRACEBACK", "")
    assert main([*words, str(tmp_path / "none")]) == 2
    assert "Traceback" in capsys.readouterr().err


def test_traceback_is_shown_on_demand(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("COSTEER_TRACEBACK", "1")
    assert exit_code_of(raising(ValueError("no"))) == 2
    assert "Traceback" in capsys.readouterr().err


def test_unknown_command_names_the_nearest(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["docter"]) == 2
    assert capsys.readouterr().err == (
        "costeer: No such command 'docter'. Did you mean 'doctor'?\n"
    )


def test_unknown_option_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["doctor", "--fast"]) == 2
    assert "--fast" in capsys.readouterr().err


def test_system_error_says_what_the_system_says(
    capsys: pytest.CaptureFixture[str],
) -> None:
    exit_code_of(raising(OSError(errno.EMFILE, "")))
    assert capsys.readouterr().err == f"costeer: {os.strerror(errno.EMFILE)}\n"


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--participants", "abc"], "'--participants': 'abc' is not a whole number"),
        (["--participants", "1.5"], "'--participants': '1.5' is not a whole number"),
        (["--length", "12,5"], "'--length': '12,5' is not a length; give metres"),
        (["--speed", "fast"], "'fast' is not a speed; give metres per second"),
        (["--colour"], "No such option: --colour"),
    ],
)
def test_a_word_that_cannot_be_read_is_named_with_the_way_out(
    words: list[str], said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["study", "--out", "never-made", *words]) == 2
    shown = capsys.readouterr().err
    assert said in shown
    assert shown.endswith("; see costeer study --help\n")
    assert shown.count("\n") == 1


def test_a_repeated_option_names_the_word_that_is_wrong(
    capsys: pytest.CaptureFixture[str],
) -> None:
    words = ["--trigger-at", "3", "--trigger-at", "soon"]
    assert main(["simulate", "--out", "never-made.parquet", *words]) == 2
    assert "'soon' is not a number" in capsys.readouterr().err


def test_a_process_without_stderr_still_works(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sys.stderr", None)
    assert main(["analyse", "never-made.csv"]) == 2
    if sys.stderr is not None:
        sys.stderr.close()  # what main opened in its place


def test_a_home_that_cannot_be_written_is_no_news() -> None:
    words = "from costeer.cli import main; main(['--version']); import matplotlib"
    without = {k: v for k, v in os.environ.items() if k != "MPLCONFIGDIR"}
    told = subprocess.run(
        [sys.executable, "-c", words],
        env=without | {"HOME": os.devnull, "XDG_CONFIG_HOME": "", "XDG_CACHE_HOME": ""},
        capture_output=True,
        text=True,
        check=True,
    )
    assert told.stderr == ""


def test_an_interruption_anywhere_ends_with_130() -> None:
    # Through `exec` of text, as in Numba: Python would end by SIGINT.
    program = (
        "import sys\n"
        "from costeer.cli.errors import exit_code_of\n"
        "sys.exit(exit_code_of(lambda: exec('raise KeyboardInterrupt')))\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stderr) == (130, "costeer: stopped\n")


def test_an_interruption_while_starting_is_one_line(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def stopped() -> int:
        raise KeyboardInterrupt

    monkeypatch.setattr("costeer.cli.main", stopped)
    assert run() == 130
    assert capsys.readouterr().err == "costeer: stopped\n"


def test_without_a_compiler_it_says_so(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("NUMBA_DISABLE_JIT", "1")
    assert main(["doctor"]) == 2
    assert "NUMBA_DISABLE_JIT is set" in capsys.readouterr().err
