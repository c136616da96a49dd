"""Faults put into the code that keeps people safe: does a test notice each?

    python -m benchmarks.mutants [NUMBER] [FILE ...]

Takes NUMBER (60) places at random of the torque guard, the watchdog, the loop of a
drive, the limits, the verdict and the server's checks (or of these FILEs alone),
changes one thing in each (a comparison, an operator, a number, min or max, and or or, a
flag), and runs the tests of that file. Prints what became of each, and the score;
changes that nobody can observe are told apart, with the reason, and do not count. Exit
code 1 below 95 %.
"""

from __future__ import annotations

import ast
import os
import random
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).parents[1]
PACKAGE = ROOT / "src" / "costeer"
SEED = 1
WANTED = 0.95
PATIENCE = 600
"""Tests that run for so long go round for ever, which is noticed [s]."""

TESTS = {
    "runtime/guard.py": [
        "tests/runtime/test_guard.py",
        "tests/runtime/test_promises.py",
    ],
    "runtime/watchdog.py": [
        "tests/runtime/test_watchdog.py",
        "tests/runtime/test_promises.py",
    ],
    "runtime/driving.py": [
        "tests/runtime/test_driving.py",
        "tests/runtime/test_driving_faults.py",
        "tests/runtime/test_stall.py",
        "tests/runtime/test_promises.py",
        "tests/runtime/test_driving_wheel.py",
    ],
    "web/security.py": ["tests/web/test_security.py"],
    "controller/actuation.py": ["tests/controller/test_actuation.py", "tests/paper"],
    "controller/consistency.py": [
        "tests/controller/test_consistency.py",
        "tests/controller/test_hands.py",
        "tests/paper",
    ],
    "controller/hands.py": ["tests/controller/test_hands.py"],
}
"""What is changed, and the tests that should see it."""

UNSEEN = {
    (
        "runtime/driving.py",
        "if not math.isfinite(row[_POSITION] + row[_ANGLE]):",
        "row[_POSITION] + row[_ANGLE] -> row[_POSITION] - row[_ANGLE]",
    ): "sum and difference of the same numbers are finite together",
    (
        "runtime/driving.py",
        "self._last_event = self._paused_at = 0.0",
        "0.0 -> 1.0",
    ): "both are set before they are read; no trial begins with an event",
    (
        "runtime/driving.py",
        "self._leaders, self._last_event = 0, 0.0",
        "0.0 -> 1.0",
    ): "the first row of a trial, which has no event, sets it before it is read",
    (
        "web/security.py",
        "await asyncio.sleep(0.05)",
        "0.05 -> 1.065",
    ): "a refused socket is waited for, and longer is as good",
}
"""Changes that nobody can observe, by file, line and change, with the reason."""

COMPARISONS = {
    ast.Lt: ast.GtE,
    ast.LtE: ast.Gt,
    ast.Gt: ast.LtE,
    ast.GtE: ast.Lt,
    ast.Eq: ast.NotEq,
    ast.NotEq: ast.Eq,
    ast.In: ast.NotIn,
    ast.NotIn: ast.In,
    ast.Is: ast.IsNot,
    ast.IsNot: ast.Is,
}
OPERATORS = {ast.Add: ast.Sub, ast.Sub: ast.Add, ast.Mult: ast.Div, ast.Div: ast.Mult}
OPERATORS |= {ast.BitAnd: ast.BitOr, ast.BitOr: ast.BitAnd}
NAMES = {"min": "max", "max": "min", "all": "any", "any": "all"}
NAMES |= {"minimum": "maximum", "maximum": "minimum"}


CHANGEABLE = (ast.Compare, ast.BinOp, ast.BoolOp, ast.UnaryOp)
CHANGEABLE += (ast.Name, ast.Attribute, ast.Constant)


class Mutant(NamedTuple):
    """One changed file.

    Attributes:
        file: In the package.
        line: Of the change.
        told: What was changed.
        source: The line as it was.
        text: Of the whole changed file.
    """

    file: str
    line: int
    told: str
    source: str
    text: str


def changed(node: ast.AST) -> str:
    """Change a node in place; return what was done, empty if nothing can be."""
    before = ast.unparse(node) if isinstance(node, ast.expr) else ""
    if isinstance(node, ast.Compare) and type(node.ops[0]) in COMPARISONS:
        node.ops[0] = COMPARISONS[type(node.ops[0])]()
    elif isinstance(node, ast.BinOp) and type(node.op) in OPERATORS:
        node.op = OPERATORS[type(node.op)]()
    elif isinstance(node, ast.BoolOp):
        node.op = ast.Or() if isinstance(node.op, ast.And) else ast.And()
    elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
        node.op = ast.UAdd()
    elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.Not):
        node.op = ast.UAdd()
        node.operand = ast.Call(ast.Name("bool", ast.Load()), [node.operand], [])
    elif isinstance(node, ast.Name) and node.id in NAMES:
        node.id = NAMES[node.id]
    elif isinstance(node, ast.Attribute) and node.attr in NAMES:
        node.attr = NAMES[node.attr]
    elif isinstance(node, ast.Constant) and type(node.value) in (bool, int, float):
        value = node.value
        node.value = not value if isinstance(value, bool) else value * 1.3 + 1
    else:
        return ""
    return f"{before} -> {ast.unparse(node)}"


def mutants(file: str) -> Iterator[Mutant]:
    """Every change of a file."""
    sound = (PACKAGE / file).read_text("utf-8")
    tree, lines = ast.parse(sound), sound.splitlines()
    hints = {id(part) for hint in _hints(tree) for part in ast.walk(hint)}
    for node in list(ast.walk(tree)):
        if id(node) in hints or not isinstance(node, CHANGEABLE):
            continue  # hints are never run
        fields = vars(node)
        before = {n: [*v] if isinstance(v, list) else v for n, v in fields.items()}
        if told := changed(node):
            source = lines[node.lineno - 1].strip()
            yield Mutant(file, node.lineno, told, source, ast.unparse(tree))
        fields.update(before)


def _hints(tree: ast.AST) -> Iterator[ast.AST]:
    """The type hints of a file."""
    for node in ast.walk(tree):
        for name in ("annotation", "returns"):
            if (hint := getattr(node, name, None)) is not None:
                yield hint


def survives(mutant: Mutant, package: Path) -> bool:
    """Whether the tests of the file pass with the change.

    Args:
        mutant: The change.
        package: A copy of the package.
    """
    place = package / mutant.file
    sound = place.read_text("utf-8")
    place.write_text(mutant.text, "utf-8")
    words = [sys.executable, "-m", "pytest", "-q", "-x", "-p", "no:cacheprovider"]
    where = os.environ | {"PYTHONPATH": str(package.parent), "CI": "true"}
    try:
        done = subprocess.run(
            [*words, *TESTS[mutant.file]],
            cwd=ROOT,
            env=where,
            capture_output=True,
            check=False,
            timeout=PATIENCE,
        )
    except subprocess.TimeoutExpired:
        return False
    finally:
        place.write_text(sound, "utf-8")
    return done.returncode == 0


def drawn(number: int, files: list[str]) -> list[Mutant]:
    """So many changes of these files at random, those of one file together."""
    every = [each for file in files for each in mutants(file)]
    print(f"{min(number, len(every))} of {len(every)} changes", flush=True)
    return random.Random(SEED).sample(every, min(number, len(every)))


def main() -> int:
    """Print what survived and the score; return the exit code."""
    words = sys.argv[1:]
    number = int(words.pop(0)) if words and words[0].isdigit() else 60
    counted, alive = 0, 0
    with tempfile.TemporaryDirectory() as folder:
        package = Path(folder) / "costeer"
        shutil.copytree(PACKAGE, package)
        for mutant in drawn(number, words or list(TESTS)):
            about = f"{mutant.file}:{mutant.line}: {mutant.told}"
            if why := UNSEEN.get((mutant.file, mutant.source, mutant.told)):
                print(f"cannot be observed: {about}: {why}", flush=True)
                continue
            counted += 1
            lives = survives(mutant, package)
            alive += lives
            print(f"{'survived' if lives else 'noticed'}: {about}", flush=True)
    score = 1.0 - alive / counted
    print(f"{counted} counted, {alive} survived: {score:.0%} noticed")
    return int(score < WANTED)


if __name__ == "__main__":
    sys.exit(main())
