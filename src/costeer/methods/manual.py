"""No assistance: the guidance is computed in the shadow and never applied.

It runs so that the intention trigger can be judged in manual driving too; with a
strength factor of 0 the motor gives no torque.
"""

from __future__ import annotations

from costeer.controller import step as controller
from costeer.methods.interface import Method

MANUAL = Method(
    name="manual",
    source="Yan et al., condition without assistance",
    assists=False,
    initial_state=controller.initial_state,
    step=controller.step,
)
