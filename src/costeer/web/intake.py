"""How much a page may say: messages a second, and refused ones until it is shut out."""

from __future__ import annotations

from typing import NamedTuple


class IntakeParameters(NamedTuple):
    """Limits of one socket.

    Attributes:
        message_rate: Messages that may come in the long run [1/s]. Source: assumed,
            eight times the 60 inputs a second of a page that steers by mouse.
        burst: Messages that may come at once [-]. Source: assumed, what a page that
            was halted for a second has saved up.
        most_refused: Refused messages until the socket is closed [-]. Source: assumed,
            more than a page of another version sends by mistake before someone looks.
    """

    message_rate: float = 500.0
    burst: float = 500.0
    most_refused: int = 20


class IntakeState(NamedTuple):
    """What is remembered of one socket.

    Attributes:
        time: Of the newest message [s].
        allowance: Messages that may still come at once [-].
        num_refused: Messages refused so far [-].
    """

    time: float
    allowance: float
    num_refused: int


def initial_state(parameters: IntakeParameters, time: float) -> IntakeState:
    """The state of a socket that was opened at `time` [s]."""
    return IntakeState(time=time, allowance=parameters.burst, num_refused=0)


def admit(
    parameters: IntakeParameters, state: IntakeState, time: float
) -> tuple[IntakeState, bool]:
    """Count a message that came at `time` [s]; say whether it may be read."""
    earned = max(0.0, time - state.time) * parameters.message_rate
    allowance = min(parameters.burst, state.allowance + earned)
    admitted = allowance >= 1.0
    left = allowance - 1.0 if admitted else allowance
    return IntakeState(time, left, state.num_refused), admitted


def refuse(state: IntakeState) -> IntakeState:
    """Count a message that was refused."""
    return IntakeState(state.time, state.allowance, state.num_refused + 1)


def is_exhausted(parameters: IntakeParameters, state: IntakeState) -> bool:
    """Whether so much was refused that the socket is to be closed."""
    return state.num_refused >= parameters.most_refused
