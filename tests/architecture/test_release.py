"""The files that a release and its visitors rely on agree with the package."""

from __future__ import annotations

import json
import re
import tomllib
from pathlib import Path
from typing import Any

import pytest
import yaml

from tests.architecture.source import ROOT

GITHUB = ROOT / ".github"
WORKFLOWS = sorted((GITHUB / "workflows").glob("*.yml"))
FORMS = [
    form
    for form in sorted((GITHUB / "ISSUE_TEMPLATE").glob("*.yml"))
    if form.stem != "config"
]


# Any: settings of other programs, of which a test looks at a few.
def settings() -> dict[str, Any]:
    """What pyproject.toml says."""
    return tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))


def parsed(file: Path) -> dict[str, Any]:
    """A YAML file of the repository."""
    content = yaml.safe_load(file.read_text("utf-8"))
    assert isinstance(content, dict), file.name
    return content


def make_targets() -> set[str]:
    """Targets that the Makefile has."""
    text = (ROOT / "Makefile").read_text("utf-8")
    return set(re.findall(r"^([a-z][a-z-]*)(?: [a-z][a-z-]*)*:", text, re.MULTILINE))


def test_the_citation_is_of_this_version() -> None:
    citation, project = parsed(ROOT / "CITATION.cff"), settings()["project"]
    assert citation["cff-version"] == "1.2.0"
    assert {"message", "title", "authors"} <= set(citation)
    assert citation["version"] == project["version"]
    assert citation["license"] == project["license"]
    assert citation["keywords"] == project["keywords"]


def test_the_changelog_has_this_version_below_what_is_unreleased() -> None:
    changelog = (ROOT / "CHANGELOG.md").read_text("utf-8")
    heads = re.findall(r"^## (.*)$", changelog, re.MULTILINE)
    released = parsed(ROOT / "CITATION.cff")["date-released"]
    assert heads[0] == "[Unreleased]"
    assert heads[1] == f"[{settings()['project']['version']}] - {released}"


def test_the_version_is_written_down_nowhere_else() -> None:
    number = re.escape(settings()["project"]["version"])
    sources = (ROOT / "src").rglob("*.py")
    written = re.compile(rf"""["']{number}["']""")
    assert [f.name for f in sources if written.search(f.read_text("utf-8"))] == []


def test_the_citation_leads_to_the_paper() -> None:
    (paper,) = parsed(ROOT / "CITATION.cff")["references"]
    # NOTICE names the paper too; line ends apart, in the same words.
    notice = " ".join((ROOT / "NOTICE").read_text("utf-8").split())
    assert paper["title"] in notice
    assert paper["journal"] in notice
    # Two of them are called Yang; the format wants every author to be another.
    assert len({tuple(author.values()) for author in paper["authors"]}) == 6
    names = [author["family-names"] for author in paper["authors"]]
    assert f"{', '.join(names[:-1])} and {names[-1]}" in notice


@pytest.mark.parametrize("workflow", WORKFLOWS, ids=lambda file: file.name)
def test_a_workflow_runs_what_exists(workflow: Path) -> None:
    steps = [
        step.get("run", "")
        for job in parsed(workflow)["jobs"].values()
        for step in job["steps"]
    ]
    called = {name for step in steps for name in re.findall(r"\bmake ([a-z-]+)", step)}
    scripts = {name for step in steps for name in re.findall(r"\bbash (\S+)", step)}
    assert called <= make_targets()
    assert scripts
    assert [name for name in scripts if not (ROOT / name).is_file()] == []


@pytest.mark.parametrize("page", ["CONTRIBUTING.md", "SECURITY.md", ".ci/run"])
def test_a_page_names_make_targets_that_exist(page: str) -> None:
    text = (ROOT / page).read_text("utf-8")
    called = re.findall(r"^(?:.*`)?make ([a-z-]+)", text, re.MULTILINE)
    assert set(called) <= make_targets()


@pytest.mark.parametrize(
    "page", ["CONTRIBUTING.md", "SECURITY.md", "CODE_OF_CONDUCT.md"]
)
def test_links_of_a_page_lead_to_files(page: str) -> None:
    links = re.findall(r"\]\(([^)#:]+)\)", (ROOT / page).read_text("utf-8"))
    assert [link for link in links if not (ROOT / link).is_file()] == []


@pytest.mark.parametrize("form", FORMS, ids=lambda file: file.name)
def test_a_form_has_what_github_asks_of_it(form: Path) -> None:
    content = parsed(form)
    assert {"name", "description", "body"} <= set(content)
    fields = [part for part in content["body"] if part["type"] != "markdown"]
    assert all(part["attributes"]["label"] for part in fields)
    ids = [part["id"] for part in fields]
    assert len(ids) == len(set(ids)) > 0


def test_a_bug_comes_with_what_doctor_found() -> None:
    labels = [part["attributes"]["label"] for part in parsed(FORMS[0])["body"]]
    assert FORMS[0].name == "bug.yml"
    assert any("costeer doctor --report" in label for label in labels)


def test_a_source_distribution_has_all_that_is_needed_to_check_it() -> None:
    included = settings()["tool"]["hatch"]["build"]["targets"]["sdist"]["include"]
    folders = {"src", "tests", "examples", "benchmarks", "docs", "requirements"}
    assert folders <= set(included)
    assert {"Makefile", "CITATION.cff", "LICENSE", ".ci", ".github"} <= set(included)
    assert [name for name in included if not (ROOT / name).exists()] == []


def test_a_container_for_development_is_set_up_by_files_that_exist() -> None:
    folder = ROOT / ".devcontainer"
    content = json.loads((folder / "devcontainer.json").read_text("utf-8"))
    assert (folder / content["build"]["dockerfile"]).is_file()
    _, script, lock = content["postCreateCommand"].split()
    assert (ROOT / script).is_file()
    assert (ROOT / "requirements" / f"{lock}.lock").is_file()
    (image,) = re.findall(r"^FROM (\S+)", (folder / "Dockerfile").read_text(), re.M)
    assert f"FROM {image}\n" in (ROOT / "Dockerfile").read_text("utf-8")
