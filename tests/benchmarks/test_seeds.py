"""Several seeds of a study: medians, ranges, and verdicts that are chance."""

from __future__ import annotations

from pathlib import Path

import pytest

from benchmarks.seeds import (
    ASSISTED,
    disputed,
    effects,
    print_effects,
    read_arguments,
    settings,
)
from costeer.study.configuration import StudySettings

PAIRS = """measure,analysis,first,second,mean_second,mean_difference,p_corrected
sdlp,published,weak-rapid,manual,0.2,-0.02,0.001
sdlp,within,weak-rapid,manual,0.2,{difference},{p}
sdlp,within,weak-rapid,weak-gentle,0.2,0.5,0.001
sdlp,published,weak-rapid,manual,0.2,-0.02,0.001
"""


def folder(path: Path, difference: float, p: float) -> Path:
    """Tables of a study in which SDLP differs by so much in weak-rapid."""
    path.mkdir()
    (path / "pairs.csv").write_text(PAIRS.format(difference=difference, p=p))
    disputes = "".join(f"{name},0\n{name},2\n" for name in ASSISTED)
    head = "condition,num_inconsistencies\nmanual,\n"
    (path / "lane_changes.csv").write_text(head + disputes + "weak-rapid,1\n")
    return path


def test_effects_are_shares_of_manual_and_of_the_paired_test(tmp_path: Path) -> None:
    found = effects(folder(tmp_path / "one", -0.05, 0.04))
    assert found == {("sdlp", "weak-rapid"): (pytest.approx(-25.0), True)}


def test_disputes_count_lane_changes_not_inconsistencies(tmp_path: Path) -> None:
    found = disputed(folder(tmp_path / "one", -0.05, 0.04))
    assert found["strong-rapid"] == 50.0
    assert found["weak-rapid"] == pytest.approx(100.0 * 2 / 3)


def test_a_verdict_of_one_seed_alone_is_called_mixed(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    given = ((-0.05, 0.01), (-0.03, 0.2), (-0.08, 0.01))
    folders = [folder(tmp_path / str(k), *each) for k, each in enumerate(given)]
    print_effects(folders)
    told = capsys.readouterr().out
    assert "-25.0 (-40.0 to -15.0)" in told
    assert "p < 0.05 in 2 of 3  mixed" in told
    assert "1 of 1 verdicts depend on the seed" in told


def test_what_is_asked_for_reaches_the_study() -> None:
    words = ["out", "--driver", "virtual-2", "--set", "driver.learning.share=0"]
    asked = settings(read_arguments(words), 4)
    assert asked == StudySettings(
        seed=4, drivers=("virtual-2",), parameters=(("driver.learning.share", 0.0),)
    )
