"""What the repository says about itself is true, and nothing is left for later."""

from __future__ import annotations

import re
import subprocess

import pytest

from costeer.cli import CommandGroup
from tests.architecture.source import ROOT

PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
CODE = re.compile(r"^```[^`\n]*\n(.*?)^```", re.MULTILINE | re.DOTALL)
LATER = re.compile("TO" + "DO|FIX" + "ME|X" + "XX")
MACHINE = re.compile(r"(?<![\w.])/(?:work|root|home/\w+)/|/t" + "mp/[A-Za-z]")


def kept_files() -> list[str]:
    """Text files that git keeps, by their path in the repository."""
    words = ["git", "ls-files", "*.py", "*.md", "*.toml", "*.yml", "*.yaml", "Makefile"]
    listed = subprocess.run(
        words, cwd=ROOT, capture_output=True, text=True, check=False
    )
    if listed.returncode != 0:
        pytest.fail(f"git does not list the files: {listed.stderr}")
    return [name for name in listed.stdout.split() if (ROOT / name).exists()]


def code_lines(text: str) -> list[str]:
    """Lines of the code blocks of a page."""
    return [line for block in CODE.findall(text) for line in block.splitlines()]


@pytest.mark.parametrize("pattern", [LATER, MACHINE], ids=["for later", "one machine"])
def test_no_file_holds(pattern: re.Pattern[str]) -> None:
    texts = {name: (ROOT / name).read_text("utf-8") for name in kept_files()}
    assert texts
    assert [name for name, text in texts.items() if pattern.search(text)] == []


def test_commands_and_make_targets_of_the_pages_exist() -> None:
    makefile = (ROOT / "Makefile").read_text("utf-8")
    known = {f"costeer {name}" for name in CommandGroup.summaries}
    known |= {f"make {t}" for t in re.findall(r"^([a-z][a-z-]*):", makefile, re.M)}
    for page in PAGES:
        lines = "\n".join(code_lines(page.read_text("utf-8")))
        called = re.findall(r"^(?:\$ )?((?:costeer|make) [a-z]+)", lines, re.M)
        assert set(called) <= known, page.name


def test_readme_shows_the_main_job() -> None:
    lines = code_lines((ROOT / "README.md").read_text("utf-8"))
    assert any(line.startswith("make study") for line in lines)


def test_the_page_of_commands_has_them_all() -> None:
    lines = code_lines((ROOT / "docs" / "commands.md").read_text("utf-8"))
    shown = {m[1] for line in lines if (m := re.match(r"costeer ([a-z]+)", line))}
    assert shown == set(CommandGroup.summaries)


def test_the_index_leads_to_every_page() -> None:
    docs = ROOT / "docs"
    linked = set(
        re.findall(r"\]\(([^)#]+\.md)\)", (docs / "index.md").read_text("utf-8"))
    )
    pages = {page.relative_to(docs).as_posix() for page in docs.rglob("*.md")}
    assert linked == pages - {"index.md"}
