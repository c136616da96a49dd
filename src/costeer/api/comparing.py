"""Methods side by side, with the options of `costeer compare`."""

from __future__ import annotations

import os
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any

from costeer.api.recordings import File, by_name
from costeer.comparison.design import SCENARIOS, ComparisonSettings
from costeer.comparison.mistakes import NONE
from costeer.comparison.run import Placement, full_report, run_comparison
from costeer.methods.interface import Method
from costeer.methods.registry import AnyMethod
from costeer.scale.shard import WHOLE, parse_shard
from costeer.scenarios.definition import Scenario
from costeer.scenarios.mistakes import MISTAKES

if TYPE_CHECKING:
    from costeer.comparison.run import ComparisonOutcome


def compare(
    out: File,
    *,
    methods: str | Sequence[File | AnyMethod] = "all",
    scenarios: str | Sequence[File | Scenario] = SCENARIOS,
    mistakes: str | Sequence[str] = NONE,
    participants: int = 50,
    seed: int = 1,
    condition: str = "strong-normal",
    intention: str = "scripted",
    length: float | None = None,
    jobs: int | None = None,
    cluster: str = "",
    shard: str = "",
    keep_records: bool = False,
    report: bool = True,
) -> ComparisonOutcome:
    """Compare methods in a folder, or finish a comparison that was begun there.

    Args:
        out: Folder; docs/compare.md says what it will hold.
        methods: Methods, their names or places; "all", or several in a text with
            commas.
        scenarios: Scenarios, their names or files, or several in a text with commas.
        mistakes: Names of mistakes, one of which is injected at a time; "all", or
            several in a text with commas.
        participants: How many virtual drivers.
        seed: Of drivers, traffic and noise.
        condition: Of the guidance, Table IV.
        intention: "scripted" (the driver's own plan is known), "network" or "off".
        length: Of every course; that of each scenario if None [m].
        cluster: Whose workers drive, as "local:4"; none for threads.
        shard: Part of the work, "I/N"; `costeer.comparison.merge.merge_comparison`
            puts the parts together and makes the report.
        jobs: Blocks of drivers at the same time; as many as processors if None. The
            results do not depend on it.
        keep_records: Whether the record of every trial is kept.
        report: Tables, figures and `report.html`.

    Raises:
        ValueError: If a setting cannot be, or the folder is another comparison's.
        OSError: If a file cannot be read or written; finished blocks are kept.

    Example:
        >>> import costeer, tempfile
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     done = costeer.compare(
        ...         folder + "/pair",
        ...         methods=["manual", "ibhs"],
        ...         scenarios=["cut-in"],
        ...         participants=1,
        ...         length=500,
        ...         report=False,
        ...     )
        >>> done.num_trials
        2
    """
    settings = ComparisonSettings(
        methods=() if _is_all(methods) else _several(methods),
        scenarios=_several(scenarios),
        mistakes=tuple(MISTAKES) if _is_all(mistakes) else _several(mistakes),
        participants=participants,
        seed=seed,
        condition=condition,
        intention=intention,
        length=None if length is None else float(length),
        keep_records=keep_records,
    )
    made = full_report if report else None
    part = parse_shard(shard, os.environ) if shard else WHOLE
    return run_comparison(
        os.fspath(out),
        settings,
        jobs=jobs,
        placement=Placement(cluster, part),
        report=made,
    )


def _is_all(given: object) -> bool:
    return isinstance(given, str) and given.strip() == "all"


# Any: names, files, methods or scenarios.
def _several(given: Any) -> tuple[Any, ...]:
    """The members of a list, of a text with commas, or the one that is given."""
    if isinstance(given, str):
        return tuple(word.strip() for word in given.split(",") if word.strip())
    alone = isinstance(given, os.PathLike | Method | Scenario)
    several = given if isinstance(given, Iterable) and not alone else (given,)
    return tuple(by_name(each) for each in several)
