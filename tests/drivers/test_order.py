"""The order of trials matters to drivers who learn, and to nobody else."""

from __future__ import annotations

from pathlib import Path

import pytest

from costeer.drivers.driver import DriverParameters
from costeer.loop.scenario import TrialSetup, loop_parameters
from costeer.loop.trial import simulate_trial, trial_metadata


def driven(condition: str, before: float, share: float) -> bytes:
    """Applied torques of a short trial after so much guided driving [s]."""
    setup = TrialSetup(
        condition=condition,
        length=900.0,
        intention="scripted",
        guided_before=before,
        parameters=(("driver.learning.share", share),),
    )
    columns = simulate_trial(setup).columns
    return columns["driver_torque"].tobytes()


def test_the_order_of_trials_acts_on_who_learns_and_on_nobody_else() -> None:
    assert driven("strong-rapid", 0.0, 1.0) != driven("strong-rapid", 2000.0, 1.0)
    assert driven("strong-rapid", 0.0, 0.0) == driven("strong-rapid", 2000.0, 0.0)
    assert driven("manual", 0.0, 1.0) == driven("manual", 2000.0, 1.0)


def recorded(setup: TrialSetup) -> object:
    """What the record of a trial says of the guided driving before it."""
    about = trial_metadata(setup, loop_parameters(setup), None)
    configuration = about["configuration"]
    assert isinstance(configuration, dict)
    return configuration["setup"]["guided_before"]


LEARNS_NOT = (("driver.learning.share", 0.0),)
OF_ITS_OWN = str(Path(__file__).parents[2] / "examples/drivers/two_point.py")


@pytest.mark.parametrize(
    ("setup", "wanted"),
    [
        (TrialSetup(), 1234.0),
        (TrialSetup(driver="virtual-traffic"), 1234.0),
        (TrialSetup(parameters=LEARNS_NOT), None),
        (TrialSetup(driver="virtual-2"), None),
        (TrialSetup(driver="hands-off"), None),
        (TrialSetup(driver=OF_ITS_OWN), None),
        # Who is given as such brings what was learnt along: the practice.
        (TrialSetup(driver=DriverParameters()), 300.0),
    ],
)
def test_a_record_tells_the_guided_driving_that_acted(
    setup: TrialSetup, wanted: float | None
) -> None:
    assert recorded(setup._replace(guided_before=1234.0)) == wanted
