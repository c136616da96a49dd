"""What docs/questionnaires.md shows runs and is true."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from costeer.sessions.questionnaires.definition import (
    instrument_names,
    load_definition,
)
from costeer.sessions.questionnaires.instrument import load_instrument, unfilled
from costeer.sessions.questionnaires.texts import load_texts

PAGE = (Path(__file__).parents[3] / "docs" / "questionnaires.md").read_text("utf-8")


def blocks(kind: str) -> list[str]:
    """Code blocks of a kind."""
    return re.findall(rf"^```{kind}\n(.*?)^```", PAGE, re.MULTILINE | re.DOTALL)


def test_the_python_of_the_page_prints_what_it_says(
    capsys: pytest.CaptureFixture[str],
) -> None:
    (code,), (printed,) = blocks("python"), blocks("text")
    exec(compile(code, "questionnaires.md", "exec"), {})
    assert capsys.readouterr().out == printed


def test_the_yaml_of_the_page_is_an_instrument(tmp_path: Path) -> None:
    for block in blocks("yaml"):
        path = tmp_path / block.splitlines()[0].removeprefix("# ")
        path.parent.mkdir()
        path.write_text(block, "utf-8")
    comfort = load_instrument("comfort", "en", tmp_path)
    assert comfort.texts["tense"].text == "I was tense."
    assert comfort.texts["at_ease"].high == "Completely"
    assert load_texts("en", tmp_path).pages["welcome_title"] == "Good morning"
    assert unfilled(load_instrument("consent", "en", tmp_path)) == ()


def test_the_table_has_every_instrument_and_score() -> None:
    lines = {
        name[1]: line
        for line in PAGE.splitlines()
        if (name := re.match(r"\| `([a-z-]+)` \|", line))
    }
    for name in instrument_names():
        scores = ", ".join(f"`{score.name}`" for score in load_definition(name).scores)
        assert lines[name].split(" | ")[2] == (scores or "none")


@pytest.mark.parametrize("name", ["ssq", "fms"])
def test_the_page_names_the_limit_to_stop_at(name: str) -> None:
    stop = load_definition(name).stop
    assert stop is not None
    (line,) = [p for p in re.split(r"\n- ", PAGE) if p.startswith(f"**{name.upper()}.")]
    assert f"{stop.at_least:g} or more (assumed)" in " ".join(line.split())


def test_the_page_says_which_languages_are_not_validated() -> None:
    plain = " ".join(PAGE.split())
    assert (
        "German and Japanese are translations of costeer's own, not validated" in plain
    )
