"""Calibrations lie where the system keeps settings, or where one wants them."""

from __future__ import annotations

from pathlib import Path

import pytest

from costeer.devices.home import home_folder

ELSEWHERE = (Path.cwd() / "elsewhere").absolute()


@pytest.mark.parametrize("platform", ["linux", "win32", "darwin"])
def test_the_chosen_folder_is_taken_as_it_is(platform: str) -> None:
    chosen = {"COSTEER_HOME": str(ELSEWHERE), "XDG_CONFIG_HOME": "x", "APPDATA": "y"}
    assert home_folder(chosen, platform) == ELSEWHERE


def test_a_tilde_is_the_users_home() -> None:
    assert home_folder({"COSTEER_HOME": "~/lab"}, "linux") == Path.home() / "lab"


@pytest.mark.parametrize(
    ("platform", "place"),
    [
        ("linux", (".config",)),
        ("freebsd14", (".config",)),
        ("darwin", ("Library", "Application Support")),
        ("win32", ("AppData", "Roaming")),
    ],
)
def test_each_system_has_its_own_place(platform: str, place: tuple[str, ...]) -> None:
    assert home_folder({}, platform) == Path.home().joinpath(*place, "costeer")


@pytest.mark.parametrize(
    ("platform", "variable"), [("linux", "XDG_CONFIG_HOME"), ("win32", "APPDATA")]
)
def test_the_systems_variable_moves_it_if_it_is_a_whole_path(
    platform: str, variable: str
) -> None:
    assert home_folder({variable: str(ELSEWHERE)}, platform) == ELSEWHERE / "costeer"
    usual = home_folder({}, platform)
    assert home_folder({variable: "settings"}, platform) == usual
    assert home_folder({variable: ""}, platform) == usual


def test_the_process_says_where(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COSTEER_HOME", str(ELSEWHERE))
    assert home_folder() == ELSEWHERE
