"""Methods behind one interface: by name, and what is none."""

from __future__ import annotations

from typing import Any

import pytest

from costeer.controller.signals import Request
from costeer.methods.ibhs import IBHS, TUNABLES
from costeer.methods.interface import usual_parameters
from costeer.methods.manual import MANUAL
from costeer.methods.registry import METHODS, method_named
from costeer.records.columns import COLUMNS
from tests.controller.samples import DT, LEFT_LANE, sample


@pytest.mark.parametrize("name", sorted(METHODS))
def test_a_method_is_found_by_its_own_name(name: str) -> None:
    method = method_named(name)
    assert method.name == name
    assert method.source
    assert method_named(method) is method


@pytest.mark.parametrize(
    ("name", "told"),
    [
        ("stalk", r"'stalk' is not known; .* ibhs, manual"),
        ("ibsh", r"did you mean ibhs\?"),
        ("costeer.methods.ibhs:NOTHING", "has no 'NOTHING'; it has the Method IBHS"),
        ("costeer.methods.ibhs:TUNABLES", "is a tuple, no Method"),
        ("no.such.module:METHOD", "there is no module 'no' to import"),
        ("no/such/file.py", "there is no file"),
    ],
)
def test_what_is_no_method_is_refused_with_the_way_out(name: str, told: str) -> None:
    with pytest.raises(ValueError, match=told):
        method_named(name)


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ({"name": "My Method"}, "is called 'My Method'; give it a name of small"),
        ({"step": None}, "has no step function; it is None"),
        ({"parameters": lambda *_: 1.0}, "are 1.0; give a named tuple"),
        ({"parameters": lambda: None}, "broke: TypeError"),
        ({"tunables": (TUNABLES[0]._replace(leaf="x"),)}, "lies at 'x', which is none"),
        ({"columns": COLUMNS[:1]}, "column 'time' .* must begin with method_"),
    ],
)
def test_a_method_that_the_loop_cannot_run_is_refused(
    changes: dict[str, Any], told: str
) -> None:
    with pytest.raises(ValueError, match=told):
        method_named(IBHS._replace(**{"name": "rival"} | changes))


def test_only_manual_driving_goes_without_assistance() -> None:
    assert [m.name for m in METHODS.values() if not m.assists] == ["manual"]


@pytest.mark.parametrize(("method", "helps"), [(IBHS, True), (MANUAL, False)])
def test_a_method_steps_from_its_own_state(method: Any, helps: bool) -> None:
    parameters = usual_parameters(method)
    state = method.initial_state(parameters, LEFT_LANE)
    shifted = sample(lateral_position=0.5)
    _, signals = method.step(parameters, state, shifted, Request(), DT)
    assert signals.guidance.instructed_torque < 0.0  # back to the centre, to the right
    assert (signals.applied_torque < 0.0) is helps
