"""The documentation site: every page is found, every public name is explained."""

from __future__ import annotations

import re
import tomllib
from typing import Any

import pytest
import yaml

import costeer
from tests.architecture.source import ROOT

DOCS = ROOT / "docs"


SITE: dict[str, Any] = yaml.safe_load((ROOT / "mkdocs.yml").read_text("utf-8"))
GALLERY = (DOCS / "gallery.md").read_text("utf-8")


def pages_of(entries: list[dict[str, Any]]) -> list[str]:
    """All pages of a navigation, section by section."""
    found: list[str] = []
    for entry in entries:
        ((_, told),) = entry.items()
        found += [told] if isinstance(told, str) else pages_of(told)
    return found


def test_every_page_is_in_the_navigation_once() -> None:
    pages = sorted(page.relative_to(DOCS).as_posix() for page in DOCS.rglob("*.md"))
    assert sorted(pages_of(SITE["nav"])) == pages


def test_the_navigation_has_the_four_kinds_of_pages() -> None:
    sections = [next(iter(entry)) for entry in SITE["nav"]]
    assert sections[1:5] == ["Tutorials", "How-to", "Explanation", "Reference"]


def test_the_pages_of_python_explain_all_that_is_public_once() -> None:
    texts = [page.read_text("utf-8") for page in (DOCS / "api").glob("*.md")]
    told = re.findall(r"^::: costeer\.(\S+)", "\n".join(texts), re.MULTILINE)
    names = [name.rpartition(".")[2] for name in told]
    public = set(costeer.__all__) - {"__version__"}
    assert sorted(names) == sorted(public | {"SteeringEnvironment", "write_fmu"})


def test_no_page_asks_another_server_for_anything() -> None:
    # Material fetches fonts unless told not to, and mermaid if a page has a diagram.
    assert SITE["theme"]["font"] is False
    assert all((DOCS / name).is_file() for name in SITE["extra_javascript"])
    for page in DOCS.rglob("*.md"):
        text = page.read_text("utf-8")
        assert not re.search(r"!\[[^\]]*\]\(https?:|<script|```mermaid", text), page


def test_the_theme_and_the_reader_of_sources_are_pinned() -> None:
    asked = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))
    names = "\n".join(asked["project"]["optional-dependencies"]["dev"])
    lock = (ROOT / "requirements" / "dev.lock").read_text("utf-8")
    for package in ("mkdocs-material", "mkdocstrings-python"):
        assert package in names
        assert f"\n{package}==" in lock


def test_the_gallery_shows_pictures_and_what_made_them() -> None:
    pictures = re.findall(r"!\[([^\]]+)\]\(([^)]+)\)", GALLERY)
    assert len(pictures) >= 15
    assert len({name for _, name in pictures}) == len(pictures)
    for told, name in pictures:
        assert (DOCS / name).stat().st_size > 5_000, name
        assert len(told.split()) >= 4, name
    shown = {name.partition("/")[2] for _, name in pictures}
    drawn = {
        file.relative_to(DOCS / "figures").as_posix()
        for file in (DOCS / "figures").rglob("*.*")
    }
    assert drawn - shown == set()


@pytest.mark.parametrize("section", re.split(r"^## ", GALLERY, flags=re.M)[1:])
def test_each_section_of_the_gallery_has_a_command_or_code(section: str) -> None:
    assert re.search(r"^```(sh|python)$", section, re.MULTILINE)


def test_the_figures_of_a_study_are_named_as_the_study_names_them() -> None:
    from costeer.study.figures.catalogue import FIGURE_NAMES

    part = GALLERY.partition("## The experiment")[2].partition("\n## ")[0]
    named = re.findall(r"`([\w-]+)\.svg`", part)
    assert len(named) == 7
    assert set(named) <= set(FIGURE_NAMES)


@pytest.mark.slow
def test_the_code_of_the_gallery_runs(
    tmp_path: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    (code,) = re.findall(r"```python\n(.*?)```", GALLERY, re.DOTALL)
    monkeypatch.chdir(tmp_path)
    exec(compile(code, "docs/gallery.md", "exec"), {})
    assert (tmp_path / "trial.svg").stat().st_size > 5_000
