"""Breaks: how much is left of one, whatever happens to server and clocks meanwhile."""

from __future__ import annotations

from costeer.sessions.session import Session
from costeer.sessions.standing import Standing
from costeer.sessions.store import Moment, StoreError, now, seconds_of


def break_left(session: Session, standing: Standing) -> float:
    """Time until the break that is on is over [s].

    It counts from when it was first shown, which is kept. On a full disk it has not
    begun yet.
    """
    whole = 60.0 * standing.step.minutes
    try:
        began = _began(session, standing.participant, standing.step.id)
    except StoreError:
        return whole
    return max(0.0, whole - _seconds(began, now()))


def _seconds(began: Moment, here: Moment) -> float:
    """Time between two moments [s].

    The monotonic clock tells it, so that it does not matter if the other one is set.
    After a restart of the computer, where that clock begins anew, the wall clock does;
    if the moment is still to come by it, no time has passed.
    """
    steady = here.monotonic - began.monotonic
    if steady >= 0.0:
        return steady
    return max(0.0, seconds_of(here.utc) - seconds_of(began.utc))


def _began(session: Session, participant: str, step: str) -> Moment:
    """When a break was first shown: now, if it was not; one that is repeated anew.

    Raises:
        StoreError: If it cannot be kept.
    """
    told = session.store.rows(
        "SELECT kind, utc, monotonic FROM events WHERE participant = ? AND step = ? "
        "AND kind IN ('break', 'repeat') ORDER BY number DESC LIMIT 1",
        *(participant, step),
    )
    if told and told[0]["kind"] == "break":
        return Moment(told[0]["utc"], told[0]["monotonic"])
    with session.store.transaction():
        session.store.tell("break", "begins", participant, step)
    return _began(session, participant, step)
