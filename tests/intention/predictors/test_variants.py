"""Which set of signals speaks, and what happens while the head is lost."""

from __future__ import annotations

import numpy as np

from costeer.intention.features import HEAD_YAW, VARIANTS
from costeer.intention.predictors.registry import fitted_predictor
from costeer.intention.predictors.store import Baseline
from costeer.intention.predictors.variants import (
    held_head,
    richest_variant,
    signals_of,
)
from tests.intention.predictors.made import features, logistic


def test_the_richest_variant_speaks() -> None:
    for name, absent in VARIANTS.items():
        assert richest_variant(VARIANTS, absent) == name
    assert richest_variant(("motion", "head"), ()) == "motion"
    assert richest_variant(VARIANTS, ("longitudinal_velocity",)) is None
    assert richest_variant(("full",), ("head_yaw",)) is None
    assert signals_of("head") == ("head_yaw", "longitudinal_velocity")


def test_a_lost_head_keeps_its_yaw_for_a_second() -> None:
    seen = features(400, 1)
    seen[200:300, HEAD_YAW] = np.nan
    held, near = held_head(seen)
    assert (held[200:300, HEAD_YAW] == seen[199, HEAD_YAW]).all()
    assert near[:260].all()
    assert not near[260:300].any()
    assert near[300:].all()


def test_a_head_that_was_never_seen_looks_ahead() -> None:
    seen = features(100, 1)
    seen[:, HEAD_YAW] = np.nan
    held, near = held_head(seen)
    assert (held[:, HEAD_YAW] == 0.0).all()
    assert not near.any()


def test_the_headless_variant_speaks_while_the_head_is_lost() -> None:
    fits = {name: logistic(name) for name in ("full", "no-head")}
    both = fitted_predictor("logistic", Baseline(fits, {}))
    seen = features(500, 2)
    seen[250:450, HEAD_YAW] = np.nan
    said = both.probabilities(seen, ())
    headless = both.probabilities(seen, ("head_yaw",))
    np.testing.assert_array_equal(said[310:450], headless[310:450])
    assert (said[450:] != headless[450:]).all()
    alone = fitted_predictor("logistic", Baseline({"full": fits["full"]}, {}))
    assert np.isnan(alone.probabilities(seen, ())[310:450]).all()
