"""Intention-based haptic guidance steering: the paper's own method."""

from __future__ import annotations

from costeer.controller import step as controller
from costeer.methods.interface import Method

IBHS = Method(
    name="ibhs",
    source="Yan et al., IEEE Transactions on Intelligent Vehicles",
    assists=True,
    initial_state=controller.initial_state,
    step=controller.step,
)
