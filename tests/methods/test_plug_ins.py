"""Methods of other people are found by file, module, entry point or as an object."""

from __future__ import annotations

import shutil
from functools import partial
from pathlib import Path
from typing import Any

import pytest

from costeer.loop.scenario import TrialSetup
from costeer.loop.trial import simulate_trial
from costeer.methods.ibhs import IBHS
from costeer.methods.interface import method_sources
from costeer.methods.registry import method_named
from tests.methods.rivals import FILE, Memory, example, rival, torque


def installed(folder: Path, package: str, points: str) -> None:
    """A package as pip leaves it: its modules and a dist-info folder."""
    about = folder / f"{package}-1.0.dist-info"
    about.mkdir(parents=True)
    (about / "METADATA").write_text(f"Name: {package}\nVersion: 1.0\n", "utf-8")
    (about / "entry_points.txt").write_text(points, "utf-8")


def test_a_file_a_module_and_the_object_are_the_same_method(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    shutil.copy(FILE, tmp_path / "keeping_module.py")
    monkeypatch.syspath_prepend(tmp_path)
    by_module = method_named("keeping_module:METHOD")
    by_file, named = method_named(str(FILE)), method_named(f"{FILE}:METHOD")
    assert by_file is named is method_named(example())
    assert by_module.name == by_file.name == "pi-keeping"


def test_an_installed_package_offers_its_method_by_name(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    shutil.copy(FILE, tmp_path / "offered_module.py")
    installed(tmp_path, "rivals", "[costeer.methods]\npi = offered_module:METHOD\n")
    monkeypatch.syspath_prepend(tmp_path)
    assert method_named("pi").name == "pi-keeping"
    with pytest.raises(ValueError, match=r"choose one of ibhs, manual, .*, pi"):
        method_named("stalk")


def test_two_installed_plug_ins_of_one_name_are_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for package in ("one", "two"):
        installed(tmp_path, package, f"[costeer.methods]\nsame = {package}:METHOD\n")
    monkeypatch.syspath_prepend(tmp_path)
    with pytest.raises(ValueError, match="'same': one:METHOD and two:METHOD; remove"):
        method_named("same")


def test_an_installed_plug_in_of_a_name_of_costeer_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    installed(tmp_path, "rivals", "[costeer.methods]\nibhs = rivals:METHOD\n")
    assert method_named("ibhs") is IBHS
    monkeypatch.syspath_prepend(tmp_path)
    with pytest.raises(ValueError, match="'ibhs': costeer's own and rivals:METHOD"):
        method_named("ibhs")
    assert method_named("manual").name == "manual"


def test_a_function_of_a_method_may_be_bound_to_data() -> None:
    usual = example()
    made = [
        usual._replace(parameters=partial(_scaled, usual.parameters, gain))
        for gain in (1.0, 1.0, 2.0)
    ]
    hashes = [method_sources(method_named(each)) for each in made]
    assert hashes[0] == hashes[1] != hashes[2]


def _scaled(usual: Any, gain: float, *world: Any) -> Any:  # Any: the example's own
    given = usual(*world)
    return given._replace(offset=gain * given.offset)


def test_two_files_of_one_name_are_refused(tmp_path: Path) -> None:
    for folder in ("a", "b"):
        (tmp_path / folder).mkdir()
        shutil.copy(FILE, tmp_path / folder / "twin_rival.py")
    method_named(str(tmp_path / "a" / "twin_rival.py"))
    with pytest.raises(ValueError, match="two plug-ins are called twin_rival"):
        method_named(str(tmp_path / "b" / "twin_rival.py"))


def test_the_name_of_a_method_of_costeer_is_taken() -> None:
    with pytest.raises(ValueError, match="two methods are called 'ibhs'"):
        method_named(example()._replace(name="ibhs"))
    assert method_named(IBHS) is IBHS


@pytest.mark.parametrize(
    ("place", "message"),
    [
        ("nowhere.py", "there is no file nowhere.py"),
        ("no_such_module:METHOD", "there is no module 'no_such_module'"),
        (f"{FILE}:RIVAL", "has no 'RIVAL'; it has the Method METHOD"),
        (f"{FILE}:SUM", "is a Column, no Method"),
        ("ibsh", r"did you mean ibhs\?"),
    ],
)
def test_a_place_without_a_method_is_refused(place: str, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        method_named(place)


def test_a_trial_is_driven_and_recorded_under_the_method_s_name() -> None:
    setup = TrialSetup(
        condition="strong-normal",
        method=example(),
        driver="hands-off",
        initial_offset=0.5,
        intention="off",
        length=100.0,
    )
    record = simulate_trial(setup, "python")
    about = record.metadata
    assert (about["method"], about["method_version"]) == ("pi-keeping", "1")
    assert len(str(about["method_source_hash"])) == 16
    assert about["torque_faults"] == 0
    # Offset gain 1.2 N·m/m and integral gain 0.2 on 0.5 m to the left, straight ahead,
    # through the motor's lag of 20 ms.
    torque = record.columns["applied_torque"]
    assert torque[0] == 0.0
    assert torque[9] == pytest.approx(-(1.2 * 0.5 + 0.2 * 0.5 * 0.15), abs=0.06)
    assert record.columns["method_integral"][0] == pytest.approx(0.5 / 60.0)


@pytest.mark.parametrize(
    ("limit", "fault", "moved"),
    [(90.0, 2.0, True), (float("nan"), 1.0, False)],
)
def test_a_torque_that_the_motor_cannot_give_is_contained_and_counted(
    limit: float, fault: float, moved: bool
) -> None:
    found = example()
    usual = found.parameters
    # The largest numbers: their product is none.
    most = 1e308
    wild = found._replace(
        parameters=lambda *world: (
            usual(*world)._replace(offset=500.0, limit=limit)
            if limit == limit
            else usual(*world)._replace(offset=most, limit=most, strength=most)
        )
    )
    setup = TrialSetup(
        condition="strong-normal",
        method=wild,
        driver="hands-off",
        initial_offset=0.5,
        intention="off",
        length=100.0,
    )
    record = simulate_trial(setup, "python")
    assert record.columns["torque_fault"][0] == fault
    assert (
        record.metadata["torque_faults"] == (record.columns["torque_fault"] > 0).sum()
    )
    assert bool((record.columns["steering_wheel_angle"] < -0.1).any()) is moved


def test_a_method_that_does_not_assist_moves_no_wheel_whatever_it_asks_for() -> None:
    # At the first step it asks for nothing, so that nothing is refused before.
    late = rival(
        lambda parameters, state, measured, *_: (
            Memory(state.last + 1.0),
            torque(2.0 * (state.last > 5.0)),
        )
    )._replace(assists=False)
    setup = TrialSetup(
        condition="strong-normal",
        method=late,
        driver="hands-off",
        intention="off",
        length=100.0,
    )
    record = simulate_trial(setup, "python")
    assert not record.columns["steering_wheel_angle"].any()
    assert record.columns["torque_fault"][10] == 2.0
    assert record.metadata["torque_faults"] == len(record.columns["time"]) - 6
