"""The locks pin every file by hash, name no registry, and agree with each other."""

from __future__ import annotations

import re
import subprocess
import sys

import pytest

from tests.architecture.source import ROOT

FOLDER = ROOT / "requirements"
LOCKS = ("installer", "base", "dev", "bench", "page")
PIN = re.compile(r"^([a-z0-9.-]+)==(\S+)(.*?)\\?$", re.MULTILINE)


def pins(lock: str) -> set[tuple[str, str, str]]:
    """Package, version and condition of every line of a lock."""
    text = (FOLDER / f"{lock}.lock").read_text("utf-8")
    return {(name, version, rest.strip()) for name, version, rest in PIN.findall(text)}


@pytest.mark.parametrize("lock", LOCKS)
def test_lock_names_no_registry(lock: str) -> None:
    text = (FOLDER / f"{lock}.lock").read_text("utf-8")
    assert not re.search(r"https?://|--(extra-)?index-url|--find-links|file:", text)


@pytest.mark.parametrize("lock", LOCKS)
def test_every_pin_has_a_hash(lock: str) -> None:
    text = (FOLDER / f"{lock}.lock").read_text("utf-8")
    entries = re.split(r"^(?=[a-z0-9])", text, flags=re.MULTILINE)[1:]
    assert len(entries) == len(pins(lock)) > 0
    assert [entry for entry in entries if "--hash=sha256:" not in entry] == []


@pytest.mark.parametrize("lock", ["dev", "bench"])
def test_lock_holds_the_base_at_the_same_versions(lock: str) -> None:
    wider = {(name, version, "") for name, version, _ in pins("base")} & pins(lock)
    always = {(name, version) for name, version, _ in wider}
    missing = pins("base") - pins(lock)
    assert [pin for pin in missing if pin[:2] not in always] == []


def test_unknown_lock_is_refused_by_name() -> None:
    words = [sys.executable, str(FOLDER / "install.py"), "everything"]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert "'everything' is no lock; give one of base, dev, bench" in done.stderr
