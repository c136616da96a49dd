"""Which wheels are found, by which backend, and what is said when packages lack."""

from __future__ import annotations

import sys

import pytest

from costeer.devices.wheels import hid, sdl
from costeer.devices.wheels.calibration import WheelCalibration
from costeer.devices.wheels.interface import WheelDescription, WheelLost
from costeer.devices.wheels.registry import (
    emergency_stop,
    found_wheels,
    open_wheel,
    prepare_stop,
)
from costeer.devices.wheels.sdl_session import sdl_library

BY_SDL = WheelDescription("sdl", "03#0", "G29", "046d-c24f")
BY_HID = WheelDescription("hid", "path", "Logitech G29", "046d-c24f-hid")
OTHER = WheelDescription("hid", "other", "Logitech G27", "046d-c29b-hid")


@pytest.fixture
def three_wheels(monkeypatch: pytest.MonkeyPatch) -> None:
    """A G29 that both backends see, a G27 that only HID sees."""
    monkeypatch.setattr(sdl, "sdl_wheels", lambda: [BY_SDL])
    monkeypatch.setattr(hid, "hid_wheels", lambda: [BY_HID, OTHER])


@pytest.mark.usefixtures("three_wheels")
@pytest.mark.parametrize("platform", ["linux", "win32"])
def test_sdl_goes_first_where_it_has_the_drivers(platform: str) -> None:
    assert found_wheels(platform=platform) == [BY_SDL, OTHER]


@pytest.mark.usefixtures("three_wheels")
def test_raw_hid_goes_first_on_macos() -> None:
    assert found_wheels(platform="darwin") == [BY_HID, OTHER]


@pytest.mark.parametrize(
    ("module", "words"),
    [("sdl2", "pysdl2"), ("hid", "hidapi"), ("can", "python-can")],
)
def test_a_missing_package_is_named_with_its_extra(
    monkeypatch: pytest.MonkeyPatch, module: str, words: str
) -> None:
    monkeypatch.setitem(sys.modules, module, None)
    kind = {"sdl2": "sdl", "hid": "hid", "can": "senso"}[module]
    description = WheelDescription(kind, "a:b", "A wheel", "046d-c24f-hid")
    told = rf"{words}.*pip install .*\[(drive|can)\]"
    with pytest.raises(ModuleNotFoundError, match=told):
        prepare_stop(description)
    with pytest.raises(ModuleNotFoundError, match=told):
        emergency_stop(description)


def test_one_backend_is_enough(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "sdl2", None)
    monkeypatch.setattr(hid, "hid_wheels", lambda: [BY_HID])
    assert found_wheels(platform="linux") == [BY_HID]


def test_without_any_backend_the_extra_is_named(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setitem(sys.modules, "sdl2", None)
    monkeypatch.setitem(sys.modules, "hid", None)
    with pytest.raises(ModuleNotFoundError, match=r"\[drive\]'") as error:
        found_wheels()
    assert error.value.name == "sdl2"


def test_the_ctypes_package_of_the_same_name_is_told(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setitem(sys.modules, "hid", sys)  # any module without `device`
    with pytest.raises(ModuleNotFoundError, match=r"pip uninstall.* hid, then: "):
        hid.hid_library()


def test_a_calibration_of_another_wheel_is_refused() -> None:
    with pytest.raises(ValueError, match="of wheel 046d-c29b, not of G29"):
        open_wheel(BY_SDL, WheelCalibration(identity="046d-c29b"))


def test_a_raw_wheel_is_opened_by_its_path() -> None:
    with pytest.raises(WheelLost, match="the wheel at path does not open"):
        open_wheel(BY_HID, WheelCalibration(identity=BY_HID.identity))


def test_an_unknown_kind_is_refused() -> None:
    strange = BY_SDL._replace(kind="brakes")
    with pytest.raises(ValueError, match="'brakes', it must be one of sdl, hid"):
        open_wheel(strange, WheelCalibration(identity="046d-c24f"))
    with pytest.raises(ValueError, match="'brakes', it must be one of sdl, hid"):
        emergency_stop(strange)


def test_a_raw_wheel_that_is_gone_needs_no_stop() -> None:
    emergency_stop(BY_HID)


def test_libraries_are_ready_before_they_are_needed() -> None:
    for kind in ("sdl", "hid", "senso", "simulated"):
        prepare_stop(BY_SDL._replace(kind=kind))
    assert {"sdl2", "hid", "can"} <= set(sys.modules)
    library = sdl_library()
    parts = library.SDL_INIT_JOYSTICK | library.SDL_INIT_HAPTIC
    assert library.SDL_WasInit(parts) == parts
    library.SDL_Quit()
