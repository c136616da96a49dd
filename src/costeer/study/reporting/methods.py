"""A paragraph for the methods section of a paper, made of what records and plan say."""

from __future__ import annotations

import platform
from collections import Counter
from importlib.metadata import version

from costeer.methods.conditions import MANUAL
from costeer.pages.numerals import listed, number, plural
from costeer.study.configuration import differences
from costeer.study.definitions import DEFAULTS
from costeer.study.material import StudyMaterial, conditions_driven, is_virtual
from costeer.study.quantities import DEG

_TORQUE = {
    "measured": "measured by the wheel",
    "observed": "observed from the motor's torque and the angle",
    "simulated": "that of the simulated hands",
}


def methods_paragraphs(material: StudyMaterial) -> tuple[str, ...]:
    """Participants and design, apparatus, exclusions, measures and tests."""
    people = () if material.people is None else material.people.said
    paragraphs = (
        [_who(material), *people],
        [*_design(material), *_apparatus(material)],
        _data(material),
        [*_measures(), *_tests(material)],
    )
    return tuple(" ".join(part for part in each if part) for each in paragraphs)


def _who(material: StudyMaterial) -> str:
    amount = int(material.trials["participant"].nunique())
    if is_virtual(material):
        return (
            f"{plural(amount, 'virtual driver')} took part, calibrated on manual "
            "driving only; no person drove."
        )
    drove = plural(amount, "participant")
    return f"{drove} drove at least one trial that was analysed."


def _design(material: StudyMaterial) -> list[str]:
    names = conditions_driven(material)
    configuration = material.study.configuration
    told = [
        f"Conditions within subjects were {listed(names)}; strength is the factor on "
        "the haptic gain (strong 1, weak 0.4), and rapid, normal and gentle are "
        "planned lane changes of 4, 6 and 8 s."
    ]
    length, speed = configuration.get("length"), configuration.get("speed")
    if isinstance(length, int | float) and isinstance(speed, int | float):
        told.append(
            f"Each trial was a course of {number(length / 1000.0, 1)} km at a "
            f"suggested {number(speed * 3.6, 0)} km/h."
        )
    changed = differences(configuration)
    if changed:
        parts = (f"{name} {value}" for name, value, _ in changed)
        told.append(f"Settings other than the published ones: {'; '.join(parts)}.")
    return told


def _apparatus(material: StudyMaterial) -> list[str]:
    about = material.metadata
    if not about:
        return []
    assisted = [each for each in about if each.get("condition") != MANUAL]
    told = []
    methods = sorted({str(each.get("method")) for each in assisted})
    if methods:
        told.append(f"Guidance was by the method {listed(methods)}{_limits(assisted)}.")
    if not is_virtual(material):
        told.append(_device(about))
    revisions = sorted({_revision(each) for each in about})
    told.append(f"Trials were run with costeer {listed(revisions)}.")
    return told


def _limits(about: list[dict[str, object]]) -> str:
    """Thresholds of the guidance on which all records agree."""
    parts = []
    for name, unit, words in (
        ("inconsistency_threshold", "W", "inconsistency threshold"),
        ("replan_gain", "", "re-plan gain"),
        ("torque_limit", "N·m", "torque limit"),
    ):
        values = {each.get(name) for each in about}
        value = values.pop() if len(values) == 1 else None
        if isinstance(value, int | float):
            parts.append(f"{words} {value:g} {unit}".rstrip())
    return f" ({', '.join(parts)})" if parts else ""


def _device(about: tuple[dict[str, object], ...]) -> str:
    devices = Counter(str(e.get("driver", "")).removeprefix("person, ") for e in about)
    sources = {_TORQUE.get(str(e.get("driver_torque_source")), "") for e in about} - {
        ""
    }
    heads = {str(each.get("head_tracker") or "") for each in about} - {""}
    told = f"Participants held: {_counted(devices)}"
    if sources:
        told += f"; the driver's torque was {listed(sorted(sources))}"
    told += (
        f"; head yaw came from: {listed(sorted(heads))}"
        if heads
        else ("; head yaw was not tracked")
    )
    return f"{told}."


def _counted(devices: Counter[str]) -> str:
    if len(devices) == 1:
        return next(iter(devices))
    parts = [f"{name} in {plural(n, 'trial')}" for name, n in sorted(devices.items())]
    return listed(parts)


def _revision(metadata: dict[str, object]) -> str:
    revision = str(metadata.get("git_revision") or "")
    known = f" (revision {revision[:12]})" if revision not in ("", "unknown") else ""
    return f"{metadata.get('version')}{known}"


def _data(material: StudyMaterial) -> list[str]:
    told = [f"{plural(len(material.trials), 'trial')} were analysed."]
    if len(material.trials) == 1:
        told = ["1 trial was analysed."]
    people = material.people
    if people is not None:
        counts = Counter(each.state for each in people.exclusions)
        parts = [f"{n} {state}" for state, n in sorted(counts.items())]
        if parts:
            why = "reasons stand in the exclusion log."
            told.append(f"Not analysed: {listed(parts)}; {why}")
        else:
            told.append("No trial was excluded or is missing.")
        if people.num_withdrawn:
            gone = plural(people.num_withdrawn, "participant")
            told.append(f"{gone} withdrew, and all their data were deleted.")
    dropped = int(material.trials["num_dropped_changes"].sum())
    changes = len(material.lane_changes)
    told.append(
        f"{plural(changes, 'lane change')} went into the measures; "
        f"{plural(dropped, 'crossing')} of the line that made none did not."
    )
    return told


def _measures() -> list[str]:
    return [
        "SDLP is the standard deviation of the lateral position in lane keeping, at "
        f"least {DEFAULTS.lane_change_margin:g} s from any lane change and outside of "
        "overtaking; the reversal rate counts turns of the steering wheel of more than "
        f"{number(float(DEFAULTS.reversal_angle) * DEG, 0)} deg after a low-pass of "
        f"{DEFAULTS.reversal_cutoff:g} Hz (Markkula and Engström, 2006). A lane change "
        "lasts from the last yaw within "
        f"{number(float(DEFAULTS.yaw_threshold) * DEG, 1)} deg before the crossing of "
        "the line to the first after it."
    ]


def _tests(material: StudyMaterial) -> list[str]:
    told = [
        "Measures were averaged for each participant and condition and tested by "
        "repeated-measures analyses of variance with Greenhouse-Geisser correction, by "
        " mixed models with participant as random effect where cells were missing, "
        "and by paired t tests against manual driving with the Benjamini-Hochberg "
        "correction over the comparisons of a measure; the level was 0.05."
    ]
    if material.answers is not None:
        told.append(
            "Items of the NASA-TLX were compared by Friedman's test and Wilcoxon's "
            "signed-rank tests, corrected alike."
        )
    if material.beside is not None:
        told.append(
            "People were compared with virtual drivers by the 95 % prediction interval "
            "of these for the mean of as many others, and by Welch's interval of the "
            "difference."
        )
    packages = [f"{name} {version(name)}" for name in ("numpy", "scipy", "pandas")]
    told.append(
        f"Analyses were made with costeer {version('costeer')} (Python "
        f"{platform.python_version()}, {listed(packages)})."
    )
    return told
