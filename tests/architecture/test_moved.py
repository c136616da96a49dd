"""Documented names of modules that moved still import the module, and only one."""

from __future__ import annotations

from importlib import import_module

import pytest

OLD_AND_NEW = (
    ("costeer.loop.record", "costeer.records.record"),
    ("costeer.loop.columns", "costeer.records.columns"),
    ("costeer.loop.linear", "costeer.validation.linear"),
    ("costeer.runtime.wheels", "costeer.devices.wheels"),
    ("costeer.runtime.wheels.simulated", "costeer.devices.wheels.simulated"),
    ("costeer.runtime.head.calibration", "costeer.devices.head.calibration"),
)


@pytest.mark.parametrize(("old", "new"), OLD_AND_NEW)
def test_an_old_name_is_the_module_at_its_new_place(old: str, new: str) -> None:
    assert import_module(old) is import_module(new)
    assert import_module(new).__spec__.name == new  # type: ignore[union-attr]


def test_a_name_that_nobody_had_is_still_an_error() -> None:
    with pytest.raises(ModuleNotFoundError):
        import_module("costeer.loop.recorder")
