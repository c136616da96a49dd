"""Parts of `costeer evaluate`: where recordings come from, who is judged, tables."""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from costeer.cli.console import note, print_table, progress
from costeer.cli.reading import AS_FOUND, Told, refuse_without_files, way_of

if TYPE_CHECKING:
    from costeer.training.assessment import Asked, Assessment
    from costeer.training.comparison import Comparison, Difference, Judged
    from costeer.training.evaluate import EvaluationParameters
    from costeer.training.recordings import Recording


class Source(NamedTuple):
    """Where the recordings come from; one of three.

    Attributes:
        files: Trial records or tables.
        simulate: Number of simulated drivers.
        seed: Of the simulated drivers.
        dataset: Name of a set of real driving.
        data: Folder of the sets; None for that of COSTEER_DATA.
        resample: Bring tables of another rate to 60 Hz.
        told: How tables are to be read.
        scenario: That simulated drivers drive in; None for the published road at
            several speeds.
        cluster: Whose workers simulate; empty for threads.
    """

    files: list[Path]
    simulate: int | None
    seed: int | None
    dataset: str | None
    data: Path | None
    resample: bool = False
    told: Told = AS_FOUND
    scenario: str | None = None
    cluster: str = ""


class Chosen(NamedTuple):
    """What is judged.

    Attributes:
        predictor: By name.
        weights: Its file; None for what ships with costeer.
        compare: Whether all others are put beside it.
        without: Signals to take away.
        ablations: Whether signals are taken away in turn.
    """

    predictor: str
    weights: Path | None
    compare: bool
    without: tuple[str, ...]
    ablations: bool


class Result(NamedTuple):
    """What is printed and written.

    Attributes:
        title: Of the printed table.
        source: What was judged on, in words.
        facts: For JSON.
        assessment: All of it.
        network: What the network's file says of its training; empty for others.
    """

    title: str
    source: str
    facts: dict[str, Any]  # Any: JSON
    assessment: Assessment
    network: dict[str, Any]  # Any: JSON


def check_source(source: Source) -> None:
    """Refuse none or several sources, and options that would do nothing.

    Raises:
        ValueError: Naming them.
    """
    given = [
        name
        for name, there in (
            ("files", bool(source.files)),
            ("--simulate", source.simulate is not None),
            ("--dataset", source.dataset is not None),
        )
        if there
    ]
    if not given:
        raise ValueError(
            "nothing to judge on: name trial records or tables, or give --simulate 24, "
            "or --dataset ngsim_lc --data FOLDER"
        )
    if len(given) > 1:
        raise ValueError(
            f"{' and '.join(given)} are different recordings; judge on one of them"
        )
    for name, value in (("--seed", source.seed), ("--scenario", source.scenario)):
        if value is not None and source.simulate is None:
            raise ValueError(f"{name} is of simulated drivers; add --simulate N")
    if source.scenario is not None:
        from costeer.scenarios.reading import scenario_named

        scenario_named(source.scenario)
    if source.cluster and source.simulate is None:
        raise ValueError("--cluster is for simulated drivers; add --simulate N")
    if source.data is not None and source.dataset is None:
        raise ValueError("--data is the folder of --dataset; add --dataset NAME")
    if source.resample and not source.files:
        raise ValueError("--resample is for tables; name them")
    refuse_without_files(bool(source.files), source.told)


def check_chosen(chosen: Chosen) -> None:
    """Refuse unknown predictors and signals before anything is read.

    Raises:
        ValueError: Naming them and what is allowed.
    """
    from costeer.intention.features import FEATURES
    from costeer.intention.predictors.registry import PREDICTORS
    from costeer.loop.outside import any_predictor

    if chosen.predictor not in PREDICTORS:
        any_predictor(chosen.predictor)
    unknown = [name for name in chosen.without if name not in FEATURES]
    if unknown:
        raise ValueError(
            f"--without {unknown[0]} is no signal; give one of {', '.join(FEATURES)}"
        )


def data_told(source: Source) -> dict[str, Any]:
    """Which data these are: set, version, and the seed of simulated drivers.

    Raises:
        OSError: If a file cannot be read.
    """
    from importlib.metadata import version

    from costeer.drivers.population import POPULATION_VERSION
    from costeer.training.datasets.catalogue import dataset_version, files_version

    if source.simulate is not None:
        state = f"population {POPULATION_VERSION}"
    elif source.dataset is not None:
        state = dataset_version(source.dataset, _folder(source))
    else:
        state = files_version(source.files)
    seed = None
    if source.simulate is not None:
        seed = 1 if source.seed is None else source.seed
    return {
        "set": source.dataset or _told(source),
        "version": state,
        "seed": seed,
        "costeer_version": version("costeer"),
    }


def _folder(source: Source) -> Path:
    """That holds the sets."""
    return source.data or Path(os.environ.get("COSTEER_DATA", "data"))


def read_source(source: Source) -> list[Recording]:
    """Read or simulate the recordings.

    Raises:
        ValueError: If a file, a set or its folder cannot be understood.
        OSError: If a file cannot be read.
    """
    if source.simulate is not None:
        from costeer.scale.cluster import workers
        from costeer.training.simulation import FIRST_UNSEEN, simulate_recordings

        seed = 1 if source.seed is None else source.seed
        with (
            workers(None, source.cluster) as pool,
            progress("simulated drivers", source.simulate) as advance,
        ):
            return simulate_recordings(
                source.simulate, seed, pool, advance, FIRST_UNSEEN, source.scenario
            )
    if source.dataset is not None:
        from costeer.training.datasets.catalogue import read_dataset

        return read_dataset(source.dataset, _folder(source))
    from costeer.training.recordings import read_recordings

    way = way_of(source.told)
    return read_recordings(source.files, source.resample, way.adaptation, way.reading)


def judge(
    parameters: EvaluationParameters,
    source: Source,
    chosen: Chosen,
    recordings: Sequence[Recording],
) -> Result:
    """Judge the chosen predictor and all that is asked beside it.

    Raises:
        ValueError: If it cannot judge the recordings.
        OSError: If its file cannot be read.
    """
    from costeer.intention.predictors.registry import OURS
    from costeer.intention.weights import load_weights
    from costeer.loop.outside import any_predictor
    from costeer.training.assessment import assess, assessment_facts
    from costeer.training.recordings import lacking

    seen = [lacking(one, chosen.without) for one in recordings]
    lacks = missing_signals(seen)
    for line in variants_told(lacks, len(seen)):
        note(line)
    weights = None if chosen.weights is None else str(chosen.weights)
    judged = any_predictor(chosen.predictor, weights)
    assessment = assess(judged, seen, _asked(chosen), parameters)
    where: dict[str, Any] = {}
    if source.simulate is not None:
        where["scenario"] = scenario_told(source)
    where["data"] = data_told(source)
    facts = {**where, "missing_signals": lacks, **assessment_facts(assessment)}
    there = f", scenario {scenario_told(source)}" if source.scenario else ""
    if judged.name != OURS:
        title = judged.title + there
        return Result(title, _told(source), facts, assessment, {})
    network = load_weights(chosen.weights)
    return Result(
        title=f"Network {network.hash[:12]}{there}",
        source=_told(source),
        facts={"intention_model_hash": network.hash, **facts},
        assessment=assessment,
        network=network.facts,
    )


def _asked(chosen: Chosen) -> Asked:
    """Rivals and ablations, as far as they are wanted."""
    from costeer.training.assessment import Asked, all_rivals

    if not chosen.compare:
        return Asked(ablations=chosen.ablations)
    return all_rivals(chosen.predictor, chosen.weights, chosen.ablations)


def _told(source: Source) -> str:
    """What is judged on, in words."""
    if source.simulate is not None:
        seed = 1 if source.seed is None else source.seed
        there = f" in scenario {scenario_told(source)}" if source.scenario else ""
        return f"{source.simulate} simulated drivers of seed {seed}{there}"
    if source.dataset is not None:
        return f"the set {source.dataset}"
    return "files " + ", ".join(file.name for file in source.files)


def scenario_told(source: Source) -> str:
    """Name of the scenario that simulated drivers drive in."""
    from costeer.scenarios.reading import scenario_named

    return scenario_named(source.scenario or "expressway").name


def missing_signals(recordings: Sequence[Recording]) -> list[dict[str, Any]]:
    """Which signals recordings lack, how many do, and the variant that speaks then."""
    from costeer.training.ablation import variant_of

    kinds = Counter(one.absent for one in recordings)
    return [
        {"missing": list(absent), "recordings": number, "variant": variant_of(absent)}
        for absent, number in kinds.items()
        if absent
    ]


def variants_told(lacks: Sequence[dict[str, Any]], total: int) -> Iterator[str]:
    """The same in words, of `total` recordings."""
    for each in lacks:
        spoken = (
            f"the variant '{each['variant']}' of the network speaks"
            if each["variant"]
            else "the network was not trained to lack just these: trust it less"
        )
        names = ", ".join(each["missing"])
        yield f"note: {each['recordings']} of {total} recordings lack {names}; {spoken}"


def print_comparisons(result: Result) -> None:
    """Print the tables of rivals and of ablations, as far as they were asked for."""
    assessment = result.assessment
    if assessment.comparison is not None:
        _print_comparison(assessment.comparison, "predictors, on the same samples")
    if assessment.ablations is not None:
        _print_comparison(assessment.ablations, "signals taken away, same samples")


_HEADINGS = (
    "accuracy",
    "balanced accuracy",
    "F1",
    "PR-AUC",
    "against reference",
    "ROC-AUC",
    "calibration error",
    "lead at rate [s]",
    "against reference",
    "missed at rate",
)


def _print_comparison(comparison: Comparison, title: str) -> None:
    from costeer.training.comparison import excluded_told

    facts = comparison.judged[0].judgement.facts
    never = facts["samples"]["accuracy_of_never"]
    heading = (
        f"{title}: {facts['num_crossings']} crossings, {facts['kilometres']:.1f} km, "
        f'accuracy of "never" {_number(never)}; leads at '
        f"{facts['false_per_km_allowed']:g} false triggers per km"
    )
    rows = [_row(one, comparison.reference) for one in comparison.judged]
    print_table(["predictor", *_HEADINGS], rows, title=heading)
    for told in excluded_told(comparison):
        note(told)


def _row(one: Judged, reference: str) -> list[str]:
    """A predictor's cells."""
    facts, differences = one.judgement.facts, one.differences
    samples, rated = facts["samples"], facts["at_false_rate"]
    own = one.name == reference
    missed = rated.get("missed")
    return [
        one.title,
        *(_number(samples[n]) for n in ("accuracy", "balanced_accuracy", "f1")),
        _number(samples["pr_auc"]),
        "reference" if own else _against(differences.get("pr_auc")),
        _number(samples["roc_auc"]),
        _number(samples["calibration_error"]),
        _number(rated.get("lead_time_median"), 2),
        "reference" if own else _against(differences.get("lead_time_at_false_rate")),
        "–" if missed is None else f"{missed:.0f}",
    ]


def _against(difference: Difference | None) -> str:
    """A difference with its interval and verdict."""
    if difference is None:
        return "–"
    if difference.low != difference.low:
        return difference.verdict
    return (
        f"{difference.value:+.3f} ({difference.low:+.3f} to {difference.high:+.3f}) "
        f"{difference.verdict}"
    )


def _number(value: float | None, digits: int = 3) -> str:
    return "–" if value is None else f"{value:.{digits}f}"


def prepare_folder(out: Path) -> None:
    """Make the folder of the report before anything is judged.

    Raises:
        ValueError: If it is a file or holds other things.
        OSError: If it cannot be written.
    """
    from costeer.validation.intention.report import prepare

    prepare(out)


def write_folder(out: Path, result: Result) -> None:
    """Write report, figures, tables and JSON, and say where."""
    from costeer.validation.intention.material import Material
    from costeer.validation.intention.report import write_report

    material = Material(result.assessment, result.facts, result.source, result.network)
    note(f"report: {write_report(out, material)}")
