"""Plans that cannot be are refused with their line, before anybody sits down."""

from __future__ import annotations

from pathlib import Path

import pytest

from costeer.cli import main
from costeer.sessions.plan_file import check_words, paper_plan_text, parsed_plan
from costeer.sessions.session import Session

HEAD = "title: a\nsteps:\n  - {kind: instruct, text: welcome}\n"


@pytest.mark.parametrize(
    ("step", "said"),
    [
        ("{kind: practise, condition: manual, minutes: 5}", "longest_minutes is nan"),
        ("{kind: break, minutes: -5}", "minutes is -5; give 0 to 120"),
        ("{kind: break, minutes: .inf}", "minutes is inf; give 0 to 120"),
        ("{kind: drive, condition: manual, conditions: [manual]}", "conditions says"),
        ("{kind: ask, instrument: ssq, minutes: 3}", "minutes says nothing here"),
        ("{kind: instruct}", "has no text"),
        (
            "{kind: practise, condition: manual, minutes: 1, longest_minutes: 2, "
            "sdlp_below: -1}",
            "sdlp_below is -1 m",
        ),
        ("{kind: drive, condition: Manual}", "did you mean manual"),
        (
            "{kind: trials, conditions: [weak-rapid], break_every: 1, minutes: -3}",
            "minutes is -3",
        ),
        ("{kind: trials, conditions: [weak-rapid, weak-rapid]}", "name each once"),
        (
            "{kind: trials, conditions: [weak-rapid], after: [{kind: drive}]}",
            "entry 1: kind 'drive' is none of ask, instruct",
        ),
    ],
)
def test_a_step_that_cannot_be_is_refused_with_its_line(step: str, said: str) -> None:
    with pytest.raises(ValueError, match=f"line 4: step 2 .*{said}"):
        parsed_plan(f"{HEAD}  - {step}\n")


def test_a_condition_that_would_be_driven_twice_is_refused_with_its_line() -> None:
    steps = "  - {kind: drive, condition: manual}\n  - {kind: break}\n"
    block = "  - {kind: trials, conditions: [weak-rapid, manual]}\n"
    with pytest.raises(
        ValueError, match=r"line 6: step 4 .*manual is driven in step 2"
    ):
        parsed_plan(f"{HEAD}{steps}{block}")
    practise = "{kind: practise, condition: manual, minutes: 1, longest_minutes: 2}"
    parsed_plan(f"{HEAD}  - {practise}\n{steps}")  # practice is no trial


@pytest.mark.parametrize(
    ("head", "said"),
    [
        ("title: ' '", "title is empty"),
        ("title: a\nseed: -1", "seed is -1; give 0 to"),
        ("title: a\nspeed_kmh: .nan", "drive-manual: speed is nan"),
        (
            "title: a\nparameters: {traffic.nothing: 1}",
            "no parameter 'traffic.nothing'",
        ),
    ],
)
def test_a_head_that_cannot_be_is_refused_with_the_file(head: str, said: str) -> None:
    with pytest.raises(ValueError, match=f"mine.yaml: .*{said}"):
        parsed_plan(f"{head}\nsteps: [{{kind: drive, condition: manual}}]", "mine.yaml")


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        (("instrument: nasa-tlx}", "instrument: tlx}"), "no instrument 'tlx'"),
        (("language: en", "language: xx"), "no language 'xx'"),
    ],
)
def test_words_that_are_not_there_are_refused_before_anybody_begins(
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    changed: tuple[str, str],
    said: str,
) -> None:
    plan = tmp_path / "mine.yaml"
    plan.write_text(paper_plan_text().replace(*changed))
    given = ["session", "new", str(tmp_path / "study"), "--plan", str(plan)]
    assert main(given) == 2
    assert said in capsys.readouterr().err
    assert not (tmp_path / "study").exists()


def test_the_words_of_a_study_count_as_words(tmp_path: Path) -> None:
    (tmp_path / "instruments").mkdir()
    item = "{name: at_ease, kind: yes_no}"
    (tmp_path / "instruments/mine.yaml").write_text(f"items: [{item}]")
    plan = parsed_plan("title: a\nsteps: [{kind: ask, instrument: mine}]")
    with pytest.raises(ValueError, match="lacks words in 'en'"):
        check_words(plan, tmp_path)
    (tmp_path / "texts").mkdir()
    words = "instruments: {mine: {title: Mine, items: {at_ease: At ease}}}"
    (tmp_path / "texts/en.yaml").write_text(words)
    check_words(plan, tmp_path)
    with pytest.raises(ValueError, match="lacks words in 'de'"):
        check_words(plan, tmp_path, "de")


def test_a_plan_in_another_encoding_is_refused_by_its_name(tmp_path: Path) -> None:
    (tmp_path / "plan.yaml").write_bytes("title: Fahrt übers Land".encode("latin-1"))
    with pytest.raises(ValueError, match=r"plan\.yaml is not YAML"):
        Session(tmp_path)
