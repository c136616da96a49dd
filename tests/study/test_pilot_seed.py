"""Pilot drivers are no participants: the threshold was set on them."""

from __future__ import annotations

import pytest

from costeer.loop.scenario import PILOT_SEED
from costeer.study.configuration import StudySettings, check_settings
from costeer.validation.pilot import agreeing_setups


def test_a_study_with_the_pilot_seed_is_refused() -> None:
    with pytest.raises(ValueError, match=r"pilot drivers.*give another seed"):
        check_settings(StudySettings(seed=PILOT_SEED))


def test_pilot_runs_have_that_seed() -> None:
    assert {setup.seed for setup in agreeing_setups(1)} == {PILOT_SEED}
