"""Sentences of the methods that only a session knows: who, in which order, how."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from statistics import mean, median, stdev
from typing import Any

from costeer.pages.numerals import listed, number, plural
from costeer.sessions.answered import Answered
from costeer.sessions.planned import plan_sentences, versions_driven
from costeer.sessions.questionnaires.definition import load_definition
from costeer.sessions.session import Session
from costeer.sessions.standing import WHOLE
from costeer.sessions.store import Row
from costeer.study.people import Drive


def sentences(
    session: Session,
    drives: Sequence[Drive],
    answered: Sequence[Answered],
    attempts: Sequence[Row],
) -> tuple[str, ...]:
    """What the plan, the answers and the attempts say, for the methods.

    Args:
        session: Of the study.
        drives: Trials that count.
        answered: Questionnaires of those who drove them.
        attempts: All drives.
    """
    analysed = {each.participant for each in drives}
    own = [each for each in attempts if each["participant"] in analysed]
    told = [
        _people(answered),
        *plan_sentences(session, versions_driven(session, analysed)),
        _practice(own),
        _instruments(session, answered),
        _devices(own),
        _latency(own),
    ]
    return tuple(each for each in told if each)


def _values(answered: Sequence[Answered], item: str) -> list[Any]:
    """Answers to an item of the demographics; Any: numbers or texts."""
    return [
        each.values[item]
        for each in answered
        if each.row["instrument"] == "demographics" and item in each.values
    ]


def _people(answered: Sequence[Answered]) -> str:
    ages = [float(each) for each in _values(answered, "age")]
    genders = Counter(str(each) for each in _values(answered, "gender"))
    parts = [_gender(name, n) for name, n in sorted(genders.items())]
    told = f"Gender: {listed(parts)}. " if parts else ""
    if len(ages) == 1:
        told += f"Age: {number(ages[0], 0)} years."
    elif ages:
        told += (
            f"Age: mean {number(mean(ages), 1)} years (SD {number(stdev(ages), 1)}, "
            f"{number(min(ages), 0)} to {number(max(ages), 0)})."
        )
    return told.strip()


def _gender(name: str, number: int) -> str:
    many = {"woman": "women", "man": "men"}.get(name, name)
    return f"{number} {(many if number > 1 else name).replace('_', ' ')}"


def _practice(attempts: Sequence[Row]) -> str:
    lengths = [
        float(each["measures"]["duration"]) / 60.0
        for each in attempts
        if each["kind"] == "practise"
        and each["state"] == WHOLE
        and each["measures"].get("duration") is not None
    ]
    if not lengths:
        return ""
    drives = plural(len(lengths), "practice drive")
    verb = "lasted" if len(lengths) == 1 else "lasted a median of"
    return f"{drives} {verb} {number(median(lengths), 1)} min."


def _instruments(session: Session, answered: Sequence[Answered]) -> str:
    known = {(each.row["instrument"], each.row["version"]) for each in answered}
    told = []
    for name, edition in sorted(known):
        if name == "consent":
            continue
        try:
            source = load_definition(name, session.folder).source.rstrip(".")
        except ValueError:
            source = ""
        told.append(f"{name} version {edition}" + (f" ({source})" if source else ""))
    return f"Questionnaires: {'; '.join(told)}." if told else ""


def _devices(attempts: Sequence[Row]) -> str:
    """Whether the wheel was calibrated, and what the last checks found wrong."""
    facts = [each["facts"] for each in attempts if each["kind"] == "drive"]
    if not facts:
        return ""
    calibrated = sum(each.get("wheel_calibration") is not None for each in facts)
    told = f"The wheel was calibrated by its self-test in {calibrated} of "
    told += f"{plural(len(facts), 'drive')}."
    wrong = sorted(
        {
            str(check.get("name"))
            for each in facts
            for check in each.get("checks") or ()
            if not check.get("well")
        }
    )
    return told + (
        f" Checks of devices failed once or more: {listed(wrong)}." if wrong else ""
    )


def _latency(attempts: Sequence[Row]) -> str:
    known = sorted(
        {str(told) for each in attempts for told in each["facts"].get("latency") or ()}
    )
    if not known:
        return "The latency from wheel to screen was not recorded."
    return f"Latency: {'; '.join(known[:3])}."
