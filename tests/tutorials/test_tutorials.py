"""Every block of docs/tutorials is run, and prints what the page says it does."""

from __future__ import annotations

import ast
import itertools
import os
import re
import signal
import subprocess
import sys
import sysconfig
from pathlib import Path
from typing import NamedTuple

import pytest

from costeer.cli import CommandGroup
from costeer.sessions.plan_file import parsed_plan

DOCS = Path(__file__).parents[2] / "docs"
PAGES = {page.stem: page for page in sorted((DOCS / "tutorials").glob("*.md"))}
FENCE = re.compile(r'^```(\w*)(?: title="([^"]+)")?\n(.*?)^```$', re.M | re.DOTALL)

SHORTER = {
    "costeer study --out out/study": " --participants 1 --length 1200",
    "--length 2000 --conditions manual,strong-normal,weak-normal": " --no-report",
    "--participants 10 --conditions": " --participants 1 --length 1200",
    "--participants 10 --scenarios": " --participants 1 --length 1200",
    "--participants 6 --conditions": " --participants 1 --length 1200",
    "--participants 500": " --participants 1 --length 1200",
    "session power": " --drivers 5 --intention scripted",
    "session run": " --no-browser --port 0",
}
"""What commands that hold the key get besides: a later option takes precedence."""

SBATCH = """#!/bin/bash
# Stands for SLURM: runs the jobs of an array, or what --wrap says, at once.
while [[ $1 == --* ]]; do
  [[ $1 == --wrap ]] && { eval "$2"; exit; }
  shift
done
size=$(sed -n 's/#SBATCH --array=1-//p' "$1")
export SLURM_CPUS_PER_TASK=1 SLURM_ARRAY_TASK_MIN=1
export SLURM_ARRAY_TASK_COUNT=$size SLURM_ARRAY_TASK_MAX=$size SLURM_ARRAY_TASK_STEP=1
for SLURM_ARRAY_TASK_ID in $(seq "$size"); do
  export SLURM_ARRAY_TASK_ID
  bash "$1" >&2
done
echo 7
"""


class Block(NamedTuple):
    """A fenced block of a page."""

    language: str
    title: str
    text: str


def blocks(name: str) -> list[Block]:
    return [Block(*found) for found in FENCE.findall(PAGES[name].read_text("utf-8"))]


def shortened(line: str) -> str:
    """A command as the tests run it."""
    return line + "".join(more for key, more in SHORTER.items() if key in line)


def squeezed(text: str) -> str:
    return " ".join(text.split())


def programs(folder: Path) -> dict[str, str]:
    """The environment of a reader's shell: costeer and python are found."""
    (folder / "bin").mkdir()
    names = {"sbatch": SBATCH}
    for name, words in (("python", ""), ("costeer", "-m costeer ")):
        names[name] = f'#!/bin/bash\nexec "{sys.executable}" {words}"$@"\n'
    for name, text in names.items():
        path = folder / "bin" / name
        path.write_text(text, "utf-8")
        path.chmod(0o755)
    scripts = sysconfig.get_path("scripts")
    path = os.pathsep.join([str(folder / "bin"), scripts, os.environ["PATH"]])
    return os.environ | {"PATH": path, "PYTHONPATH": os.pathsep.join(sys.path)}


def run(words: list[str], folder: Path, env: dict[str, str]) -> str:
    """What a command prints."""
    done = subprocess.run(
        words, cwd=folder, env=env, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, f"{words[-1]}\n{done.stdout}\n{done.stderr}"
    return done.stdout + done.stderr


def run_until_served(line: str, folder: Path, env: dict[str, str]) -> str:
    """What a server prints until it has told its addresses; then it is stopped."""
    with subprocess.Popen(
        ["bash", "-c", f"exec {line}"],
        cwd=folder,
        env=env,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    ) as serving:
        assert serving.stdout is not None
        told = ""
        for text in serving.stdout:
            told += text
            if "Ctrl-C ends" in text:
                serving.send_signal(signal.SIGINT)
        return told


def run_shell(text: str, folder: Path, env: dict[str, str]) -> str:
    r"""What the lines of a block print; a line that ends in \\ goes on."""
    lines = text.replace("\\\n", " ").splitlines()
    told = ""
    for serves, some in itertools.groupby(lines, lambda line: "session run" in line):
        here = [shortened(line) for line in some]
        if serves:
            told += "".join(run_until_served(line, folder, env) for line in here)
        else:
            told += run(["bash", "-ec", "\n".join(here)], folder, env)
    return told


@pytest.mark.slow
@pytest.mark.parametrize("name", PAGES)
def test_every_block_runs_and_prints_what_the_page_shows(
    name: str, tmp_path: Path
) -> None:
    env, printed = programs(tmp_path), ""
    for block in blocks(name):
        if block.title:
            path = tmp_path / block.title
            path.parent.mkdir(parents=True, exist_ok=True)
            longer = block.text.replace("\\\n", " ").splitlines()
            keep = path.suffix != ".sh"
            lines = longer if keep else [shortened(line) for line in longer]
            path.write_text("\n".join(lines) + "\n", "utf-8")
        elif block.language == "sh":
            printed = run_shell(block.text, tmp_path, env)
        elif block.language == "python":
            printed = run([sys.executable, "-c", block.text], tmp_path, env)
        elif block.language == "text":
            for line in block.text.splitlines():
                assert squeezed(line) in squeezed(printed), line


@pytest.mark.parametrize("name", PAGES)
def test_a_page_has_goal_time_and_steps_and_leads_on(name: str) -> None:
    text = PAGES[name].read_text("utf-8")
    assert re.search(r"\*\*Goal:\*\*.*\*\*Takes\*\*.*\*\*You need\*\*", text, re.DOTALL)
    steps = re.findall(r"^## (\d+)\. ", text, re.MULTILINE)
    assert steps == [str(k + 1) for k in range(len(steps))]
    assert len(steps) >= 5 or name == "predictor"
    assert "](../" in text.partition("## Where next")[2]


@pytest.mark.parametrize("name", PAGES)
def test_commands_are_commands_and_python_is_python(name: str) -> None:
    for block in blocks(name):
        if block.language in ("python", "py"):
            ast.parse(block.text)
        if block.language in ("sh", "bash"):
            named = re.findall(r"^costeer ([a-z]+)", block.text, re.MULTILINE)
            assert set(named) <= set(CommandGroup.summaries)


def test_only_pytorch_is_not_run() -> None:
    # Blocks without a language are commands that need a device or what people drove.
    left = [b for name in PAGES for b in blocks(name) if b.language == "py"]
    assert len(left) == 1
    assert "torch.onnx.export" in left[0].text
    bare = [b for name in PAGES for b in blocks(name) if not b.language]
    needs = ("calibrate", "report short-study", "export short-study")
    for line in (line for b in bare for line in b.text.splitlines()):
        assert any(word in line for word in needs), line


def test_the_short_plan_is_a_plan() -> None:
    (text,) = [b.text for b in blocks("people") if b.title == "short.yaml"]
    assert parsed_plan(text).length == 4000


@pytest.mark.parametrize("key", SHORTER)
def test_what_is_shortened_stands_on_a_page(key: str) -> None:
    assert any(key in page.read_text("utf-8") for page in PAGES.values())
