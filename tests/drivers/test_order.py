"""The order of trials matters to drivers who learn, and to nobody else."""

from __future__ import annotations

from costeer.loop.scenario import TrialSetup
from costeer.loop.trial import simulate_trial


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
