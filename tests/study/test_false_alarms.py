"""How often each set of tests finds an effect that is not there."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks.type_one_error import Drivers, false_alarms, main, simulated

NUM_STUDIES = 1000

# A share of 0.05 of 1,000 studies has a standard error of 0.007; three are allowed.
SPREAD = 0.021
NOMINAL = 0.05 + SPREAD


@pytest.mark.slow
def test_pooling_sees_effects_where_participants_react_in_their_own_ways() -> None:
    found = false_alarms(Drivers(1.0, 0.5, 0.0), NUM_STUDIES, seed=1)
    assert found["published"] > 0.15
    assert found["published pairs"] > 0.10
    assert found["within"] < NOMINAL
    assert found["within pairs"] < NOMINAL
    # Drivers whose reactions to all conditions are alike in size are spherical.
    assert found["uncorrected"] == pytest.approx(0.05, abs=SPREAD)
    assert found["huynh-feldt"] == pytest.approx(0.05, abs=SPREAD)


@pytest.mark.slow
def test_pooling_overlooks_effects_where_participants_merely_differ() -> None:
    found = false_alarms(Drivers(1.0, 0.0, 0.0), NUM_STUDIES, seed=2)
    assert found["published"] < 0.01
    assert found["published pairs"] < 0.01
    assert found["within"] < NOMINAL


@pytest.mark.slow
def test_a_reaction_to_guidance_as_such_calls_for_the_correction() -> None:
    found = false_alarms(Drivers(1.0, 0.25, 1.0), NUM_STUDIES, seed=3)
    assert found["uncorrected"] > NOMINAL
    assert found["within"] < NOMINAL
    assert found["huynh-feldt"] < NOMINAL


def test_drivers_differ_as_they_are_said_to() -> None:
    values = simulated(Drivers(person=3.0, reaction=2.0, guidance=5.0), 400, seed=1)
    assert values.shape == (400, 12, 7, 8)
    assert np.std(values - values.mean(axis=3, keepdims=True)) == pytest.approx(
        (7.0 / 8.0) ** 0.5, rel=0.01
    )
    means = values.mean(axis=3)
    # 4,800 participants: variances have a standard error of 2 %.
    noise = 1.0 / 8.0
    assert means[:, :, 0].var() == pytest.approx(9.0 + 4.0 + noise, rel=0.08)
    assert means[:, :, 1].var() == pytest.approx(9.0 + 4.0 + 25.0 + noise, rel=0.08)
    reaction = (means[:, :, 1] - means[:, :, 2]).var()
    assert reaction == pytest.approx(2.0 * (4.0 + noise), rel=0.08)


def test_table_has_a_row_per_kind_of_drivers(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("sys.argv", ["type_one_error", "--studies", "5"])
    main()
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) == 2 + 5
    assert all(len(line.split()) == 9 for line in lines[2:])
