"""What a user is told to install can be run where costeer runs."""

from __future__ import annotations

import json
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

from costeer.base import extras
from costeer.base.extras import install_command, pip_command


@pytest.mark.parametrize("verb", ["install", "uninstall"])
def test_the_command_runs_in_this_environment(verb: str) -> None:
    words = shlex.split(pip_command(verb))
    done = subprocess.run(
        [*words, "--help"], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    assert verb in done.stdout


@pytest.mark.parametrize(
    ("there", "command"),
    [
        ({"pip", "uv"}, f"{sys.executable} -m pip install"),
        ({"uv"}, f"{sys.executable} -m uv pip install"),
        ({"uv on the path"}, f"uv pip install --python {sys.executable}"),
        (set(), f"pip --python {sys.executable} install"),
    ],
)
def test_it_is_that_of_what_is_there(
    monkeypatch: pytest.MonkeyPatch, there: set[str], command: str
) -> None:
    def found(name: str) -> str | None:
        return name if name in there else None

    def on_path(name: str) -> str | None:
        return found(f"{name} on the path")

    monkeypatch.setattr(extras, "find_spec", found)
    monkeypatch.setattr(extras.shutil, "which", on_path)
    assert pip_command("install") == command


def test_an_interpreter_first_on_the_path_is_called_python(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(extras.shutil, "which", lambda _: sys.executable)
    assert pip_command("install").split()[0] == "python"


class Installed:
    """A distribution that came from somewhere."""

    def __init__(self, about: object) -> None:
        self.about = about

    def read_text(self, _: str) -> str | None:
        """What the installer wrote of where it came from."""
        return json.dumps(self.about) if self.about else None


@pytest.mark.parametrize("editable", [True, False])
def test_an_extra_comes_from_where_costeer_came_from(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, editable: bool
) -> None:
    clone = tmp_path / "my clone"
    clone.mkdir()
    (clone / "pyproject.toml").write_text("")
    about = {"url": clone.as_uri(), "dir_info": {"editable": editable}}
    monkeypatch.setattr(extras, "distribution", lambda _: Installed(about))
    words = shlex.split(install_command("jax"))
    assert words[-1] == f"{clone}[jax]"
    assert ("--editable" in words) == editable


def test_without_a_clone_it_comes_by_its_name(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(extras, "distribution", lambda _: Installed(None))
    assert install_command("jax").endswith(" install 'costeer[jax]'")
    assert install_command().endswith(" install costeer")
