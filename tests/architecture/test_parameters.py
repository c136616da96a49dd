"""Every parameter gives its unit and where its value comes from."""

from __future__ import annotations

import ast
import re

from tests.architecture.source import parameter_classes

UNIT = re.compile(r"\[[^\]]+\]")
SOURCE = re.compile(r"Source:|assumed", re.IGNORECASE)
ENTRY = re.compile(r"^    (\w+): (.*(?:\n {8,}.*)*)", re.MULTILINE)


def attributes(docstring: str) -> dict[str, str]:
    """What the `Attributes:` section says of each field."""
    _, _, section = docstring.partition("Attributes:\n")
    return {name: " ".join(text.split()) for name, text in ENTRY.findall(section)}


def fields(node: ast.ClassDef) -> dict[str, str]:
    """Name and annotation of each field."""
    return {
        line.target.id: ast.unparse(line.annotation)
        for line in node.body
        if isinstance(line, ast.AnnAssign) and isinstance(line.target, ast.Name)
    }


def faults(node: ast.ClassDef) -> list[str]:
    """Fields whose line in the docstring lacks something."""
    told = attributes(ast.get_docstring(node, clean=True) or "")
    wrong = []
    for name, annotation in fields(node).items():
        text = told.get(name)
        if text is None:
            wrong.append(f"{node.name}.{name}: not in the docstring")
        elif annotation.split(".")[-1].endswith("Parameters"):
            continue  # a record of parameters: its own fields give unit and source
        elif not UNIT.search(text):
            wrong.append(f"{node.name}.{name}: no [unit]")
        elif not SOURCE.search(text):
            wrong.append(f"{node.name}.{name}: neither a source nor 'assumed'")
    return wrong


def test_every_parameter_has_unit_and_source() -> None:
    classes = list(parameter_classes())
    assert classes
    assert [fault for _, node in classes for fault in faults(node)] == []


def test_a_missing_unit_and_a_missing_source_are_seen() -> None:
    source = '''
class GripParameters(NamedTuple):
    """Grip.

    Attributes:
        stiffness: Along the road [N/rad].
        radius: Of the wheel. Source: assumed.
        mass: Of the wheel, which
            is light [kg]. Source: assumed.
    """

    stiffness: Real = 1.0
    radius: Real = 1.0
    mass: Real = 1.0
    width: Real = 1.0
'''
    node = ast.parse(source).body[0]
    assert isinstance(node, ast.ClassDef)
    assert faults(node) == [
        "GripParameters.stiffness: neither a source nor 'assumed'",
        "GripParameters.radius: no [unit]",
        "GripParameters.width: not in the docstring",
    ]
