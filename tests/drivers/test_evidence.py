"""Evidence gathers beyond the usual, and what is old is forgotten."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from costeer.drivers.evidence import gathered
from tests.drivers.samples import DT

RULE = (2.0, 0.2, 1.0)  # r [1/s], e_0 and τ [s]


def after(error: float, seconds: float, evidence: float = 0.0) -> float:
    """Evidence after an error that stays."""
    for _ in range(round(seconds / DT)):
        evidence = gathered(*RULE, evidence, error, DT)
    return evidence


@pytest.mark.parametrize("error", [0.35, -0.35])
def test_evidence_follows_its_equation(error: float) -> None:
    # A' = r (|e| / e_0 - 1) - A / τ rises to r τ (|e| / e_0 - 1) (1 - exp(-t / τ)).
    wanted = 2.0 * 1.0 * (0.35 / 0.2 - 1.0) * (1.0 - math.exp(-1.5))
    assert after(error, 1.5) == pytest.approx(wanted, rel=0.01)


def test_evidence_knows_no_bound_of_its_own() -> None:
    # It ends at r τ (|e| / e_0 - 1) = 8, however far beyond the bound of 1 that is.
    assert after(1.0, 20.0) == pytest.approx(8.0, rel=1e-3)


def test_without_an_error_evidence_is_gone_in_time() -> None:
    # A' = -r - A / τ from 1 reaches 0 after τ ln(1 + 1 / (r τ)) = 0.41 s.
    assert after(0.0, 0.38, 1.0) > 0.0
    assert after(0.0, 0.44, 1.0) == 0.0


@given(st.floats(0.0, 5.0), st.floats(-0.2, 0.2))
def test_what_is_usual_is_never_evidence(evidence: float, error: float) -> None:
    assert 0.0 <= gathered(*RULE, evidence, error, DT) <= evidence


def test_where_nothing_is_usual_every_error_counts() -> None:
    assert gathered(2.0, 0.0, 1.0, 0.0, 1e-3, DT) > 1.0
