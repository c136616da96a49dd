"""docs/session.md: its plan can be driven, and every entry of a plan is explained."""

from __future__ import annotations

import re
from pathlib import Path

from costeer.methods.conditions import CONDITION_NAMES
from costeer.sessions.balance import balance
from costeer.sessions.plan import KINDS, ORDERS, Plan, PlanStep, session_steps
from costeer.sessions.plan_file import parsed_plan

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "session.md").read_text("utf-8")
SECTION = re.findall(r"^### The plan\n(.*?)^### ", PAGE, re.MULTILINE | re.DOTALL)[0]


def test_the_plan_of_the_page_is_driven_in_balanced_orders() -> None:
    (text,) = re.findall(r"```yaml\n(.*?)```", SECTION, re.DOTALL)
    plan = parsed_plan(text)
    steps = session_steps(plan, 1)
    assert [each.kind for each in steps if each.kind == "break"] == ["break"]
    assert sum(each.kind == "drive" for each in steps) == 2
    assert balance(plan, range(1, plan.participants + 1)).is_even


def test_the_page_explains_every_entry_of_a_plan() -> None:
    told = set(re.findall(r"`(\w+)`", SECTION))
    assert {*Plan._fields, *PlanStep._fields, *KINDS, *ORDERS} <= told
    for word in "-".join(CONDITION_NAMES).split("-"):
        assert word in told


def test_a_new_plan_names_the_page_that_explains_it() -> None:
    shipped = ROOT / "src" / "costeer" / "sessions" / "paper.yaml"
    assert "docs/session.md" in shipped.read_text("utf-8").splitlines()[1]


def test_pictures_of_the_page_are_there() -> None:
    for name in re.findall(r"!\[[^\]]+\]\(([^)]+)\)", PAGE):
        assert (ROOT / "docs" / name).stat().st_size > 10_000
