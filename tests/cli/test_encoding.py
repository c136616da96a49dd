"""Tables come out whatever the terminal can show."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

from costeer.cli.encoding import _plain

SHOW = (
    "import sys\n"
    "from costeer.cli.encoding import write_any_text\n"
    "from costeer.cli.console import print_table\n"
    "write_any_text()\n"
    "print_table(['torque [N·m]', 'angle [°]'], [['2', '90°'], ['ΔT', '漢é']])\n"
)


@pytest.mark.parametrize(
    ("encoding", "shown"),
    [
        ("ascii", ["torque [N*m]", "angle [ deg]", "DeltaT", "?e"]),
        pytest.param("cp932", ["ΔT", "漢e", "90°"], marks=pytest.mark.slow),
        pytest.param(
            "iso8859-2", ["torque [N*m]", "90°", "DeltaT", "?é"], marks=pytest.mark.slow
        ),
        pytest.param(
            "cp1252", ["torque [N·m]", "90°", "DeltaT", "?é"], marks=pytest.mark.slow
        ),
        ("utf-8", ["torque [N·m]", "90°", "ΔT", "漢é"]),
    ],
)
def test_what_an_encoding_lacks_is_written_in_letters_that_it_has(
    encoding: str, shown: list[str]
) -> None:
    done = subprocess.run(
        [sys.executable, "-c", SHOW],
        env=os.environ | {"PYTHONIOENCODING": encoding},
        capture_output=True,
        check=True,
    )
    text = done.stdout.decode(encoding)
    assert [word for word in shown if word not in text] == []


def test_everything_has_something_that_stands_for_it() -> None:
    assert _plain("━") == "-"
    assert _plain("┏") == "+"
    assert _plain("²") == "2"
    assert _plain("漢") == "?"
