"""`costeer doctor` finds what is there and says how to mend what is not."""

from __future__ import annotations

import json
import os
import platform
import shutil
import socket
import tempfile
from importlib.metadata import PackageNotFoundError
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest

from costeer import doctor
from costeer.base.extras import install_command
from costeer.cli import main
from costeer.cli.doctor_report import secret_words, without_names
from costeer.devices.wheels.interface import WheelDescription


class Usage(NamedTuple):
    """Room on a disk [B], as shutil tells it."""

    total: int
    used: int
    free: int


def test_a_machine_that_runs_the_tests_can_run_a_study(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert main(["doctor"]) == 0
    shown = capsys.readouterr().out
    assert "Numba engine: compiled and ran" in shown
    assert "Packages: " in shown


def test_json_holds_every_finding(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["doctor", "--json", "--out", str(tmp_path / "new" / "study")]) == 0
    findings = json.loads(capsys.readouterr().out)
    names = {finding["name"] for finding in findings}
    assert {"Python", "Cores", "Memory", "Disk", "SIMD", "Timer", "Figures"} <= names
    assert all(set(f) == {"name", "status", "detail", "remedy"} for f in findings)


def test_what_is_missing_comes_with_a_remedy_and_exit_code_1(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(shutil, "disk_usage", lambda _: Usage(10, 9, 1))
    assert main(["doctor"]) == 1
    shown = capsys.readouterr().out
    assert "missing   Disk: 0.0 GB free" in shown
    assert "to mend: free 1 GB or choose another --out" in shown


def test_an_absent_package_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    def absent(name: str) -> str:
        raise PackageNotFoundError(name)

    monkeypatch.setattr(doctor, "version", absent)
    assert doctor.check_packages().status == "missing"
    assert "numba" in doctor.check_packages().detail
    assert doctor.check_extra("jax").remedy == install_command("jax")
    assert doctor.check_extra("jax").status == "optional"


def test_a_plain_install_needs_no_extra() -> None:
    names = doctor.plain_requirements()
    assert "numba" in names
    assert not {"jax", "optax", "pytest", "highway-env"} & set(names)


def test_little_memory_is_missing(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(doctor, "total_memory", lambda: 1.0e9)
    assert doctor.check_memory().status == "missing"
    monkeypatch.setattr(doctor, "total_memory", lambda: None)
    assert doctor.check_memory().status == "ok"


def test_unwritable_code_cache_is_told(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    blocker = tmp_path / "file"
    blocker.write_text("")
    monkeypatch.setattr("costeer.base.entry.cache_folder", lambda: blocker / "numba")
    finding = doctor.check_cache()
    assert finding.status == "optional"
    assert "COSTEER_CACHE" in finding.remedy


def test_old_python_is_missing(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(doctor, "OLDEST_PYTHON", (99, 0))
    assert doctor.check_python().status == "missing"


def fails(*_: object, **__: object) -> None:
    """Stand in for something that is broken here."""
    raise OSError("broken")


def test_an_engine_that_does_not_compile_is_missing(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("numba.njit", fails)
    finding = doctor.check_numba()
    assert (finding.status, finding.detail) == ("missing", "broken")
    assert "pip install" in finding.remedy


def test_figures_that_cannot_be_drawn_are_missing(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("matplotlib.figure.Figure.savefig", fails)
    finding = doctor.check_figures()
    assert (finding.status, finding.detail) == ("missing", "broken")


def test_a_code_cache_that_a_restart_empties_is_told(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    with tempfile.TemporaryDirectory() as folder:
        monkeypatch.setattr("costeer.base.entry.cache_folder", lambda: Path(folder))
        assert doctor.check_cache().detail.endswith("lost at restart")


def test_systems_that_tell_neither_memory_nor_cores_are_no_error(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.delattr("os.sched_getaffinity", raising=False)
    monkeypatch.delattr("os.sysconf_names", raising=False)
    assert doctor.usable_cores() >= 1
    assert doctor.total_memory() is None


def test_port_that_is_taken_is_told_with_the_way_out() -> None:
    with socket.socket() as other:
        other.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        other.bind(("127.0.0.1", 8700))
        other.listen()
        finding = doctor.check_port()
    assert (finding.status, finding.detail) == ("optional", "8700 is taken")
    assert "--port 0" in finding.remedy


def test_priority_that_is_not_granted_comes_with_what_to_allow(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def refuse(*_: object) -> None:
        raise PermissionError

    monkeypatch.setattr(os, "sched_setscheduler", refuse, raising=False)
    finding = doctor.check_priority()
    assert finding.status == "optional"
    assert "limits.d" in finding.remedy


def test_looking_at_the_priority_does_not_change_it() -> None:
    if not hasattr(os, "sched_getscheduler"):
        pytest.skip("this system has no such priorities")
    before = os.sched_getscheduler(0)
    doctor.check_priority()
    assert os.sched_getscheduler(0) == before


def test_page_without_its_libraries_is_told(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr("costeer.web.pages.static_folder", lambda: tmp_path)
    assert doctor.check_page().remedy == "run: make page"


def test_wheel_that_is_not_calibrated_is_told(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    wheel = WheelDescription("sdl", "0", "Old wheel", "046d-c24f")
    monkeypatch.setenv("COSTEER_HOME", str(tmp_path))
    monkeypatch.setattr("costeer.devices.wheels.registry.found_wheels", lambda: [wheel])
    finding = doctor.check_wheels()
    assert "Old wheel is not calibrated" in finding.detail
    assert finding.remedy == "run: costeer wheel calibrate"


@pytest.mark.parametrize(("free", "status"), [(1e5, "optional"), (1e9, "ok")])
def test_shared_memory_is_enough_for_a_drive_or_told(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, free: float, status: str
) -> None:
    monkeypatch.setattr(shutil, "disk_usage", lambda _: Usage(int(1e9), 0, int(free)))
    found = doctor.check_shared_memory(tmp_path)
    assert found.status == status
    assert ("--shm-size" in found.remedy) == (status == "optional")
    assert doctor.check_shared_memory(tmp_path / "none").status == "ok"


@pytest.fixture
def somebody(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Path:
    """A user and a computer whose names are easily found in a text; their home."""
    home = tmp_path / "Users" / "gwendolen"
    home.mkdir(parents=True)
    monkeypatch.setenv("HOME", str(home))
    monkeypatch.setenv("USERPROFILE", str(home))
    for name in ("LOGNAME", "USER", "LNAME", "USERNAME"):
        monkeypatch.setenv(name, "gwendolen")
    monkeypatch.setattr(platform, "node", lambda: "lab-seven")
    monkeypatch.setattr(socket, "gethostname", lambda: "lab-seven.example.org")
    monkeypatch.setattr(socket, "getfqdn", lambda: "lab-seven.example.org")
    return home


def test_a_bug_report_says_what_there_is_but_not_whose_or_where(
    somebody: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    out = somebody / "study of Anna"
    out.mkdir()
    cache = somebody / "code"
    monkeypatch.setattr("costeer.base.entry.cache_folder", lambda: cache)
    assert main(["doctor", "--report", "--out", str(out)]) == 0
    shown = capsys.readouterr().out
    for wanted in (
        f"Python {platform.python_version()}",
        f"numpy {np.__version__}",
        "Extra drive: ",
        "Disk: ok, ",
        "Code cache: ",
        "Steering wheel: ",
    ):
        assert wanted in shown
    for secret in ("gwendolen", "Anna", "lab-seven", str(somebody), str(Path.cwd())):
        assert secret not in shown


@pytest.mark.parametrize(
    ("told", "published"),
    [
        ("{home}/code: Permission denied", "HOME: Permission denied"),
        ("free at {home}/study of Anna", "free at HOME"),
        ("driver of Gwendolen on lab-seven", "driver of USER on HOST"),
        ("lab-seven.example.org refuses", "HOST refuses"),
        ("no library in /opt/secret-project/lib", "no library in PATH"),
        (r"no library in D:\secret\lib.dll", "no library in PATH"),
        ("/dev/video0, 12.5 MB/s, 7 and/or 8", "/dev/video0, 12.5 MB/s, 7 and/or 8"),
    ],
)
def test_names_and_paths_are_left_out(
    somebody: Path, told: str, published: str
) -> None:
    secrets = secret_words(Path("out"))
    assert without_names(told.format(home=somebody), secrets) == published


def test_a_report_is_a_text_or_json_not_both(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert main(["doctor", "--report", "--json"]) == 2
    assert "give one of them" in capsys.readouterr().err
