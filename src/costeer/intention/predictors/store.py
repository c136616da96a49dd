"""The fitted numbers of the predictors as one file, and those that ship with costeer.

The format is NumPy's `.npz` without pickles: arrays named "predictor/variant/field",
and `header`, a JSON text in UTF-8 with the format's version, the signals, the hash and
what is known of each fit. The same numbers give the same bytes.
"""

from __future__ import annotations

from collections.abc import Mapping
from importlib import resources
from pathlib import Path
from types import ModuleType
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.base.files import read_whole
from costeer.intention import gru as network
from costeer.intention.arrays import (
    Arrays,
    Form,
    arrays_hash,
    check_array,
    read_arrays,
    write_arrays,
)
from costeer.intention.features import VARIANTS
from costeer.intention.predictors import (
    crossing_time,
    gru,
    head_only,
    line_time,
    logistic,
    support_vectors,
)

FORM = Form(
    version=1,
    kind="fitted predictors (.npz)",
    remedy="fit the predictors again",
)
SHIPPED = "baselines.npz"
TYPES = ("<f4", "<f8", "<i8")


class Kind(NamedTuple):
    """What a predictor's numbers look like.

    Attributes:
        weights: Named tuple of arrays.
        module: With `expected_shapes` for them.
    """

    weights: type[Any]  # Any: each predictor has its own named tuple
    module: ModuleType


KINDS: dict[str, Kind] = {
    "line-time": Kind(line_time.LineTimeWeights, line_time),
    "logistic": Kind(logistic.LogisticWeights, logistic),
    "support-vectors": Kind(support_vectors.SupportVectorWeights, support_vectors),
    "head-only": Kind(head_only.HeadWeights, head_only),
    "crossing-time": Kind(crossing_time.CrossingTimeWeights, crossing_time),
    "paper-gru": Kind(network.NetworkWeights, gru),
}
"""Predictors that the file holds, in the order of spec section 9."""


class Baseline(NamedTuple):
    """A fitted predictor and where it comes from.

    Attributes:
        variants: Named tuples of arrays by variant of `features.VARIANTS`.
        facts: What is known of the fit: choices, drivers, results; JSON.
    """

    variants: Mapping[str, Any]  # Any: each predictor has its own named tuple
    facts: dict[str, Any]  # Any: JSON


def baselines_hash(baselines: Mapping[str, Baseline]) -> str:
    """SHA-256 over names, shapes and little-endian bytes of all arrays."""
    return arrays_hash(dict(sorted(_stored(baselines).items())))


def save_baselines(path: Path, baselines: Mapping[str, Baseline]) -> None:
    """Write the file in one piece: it is there whole or not at all.

    Raises:
        ValueError: If a name is unknown or arrays do not fit together.
    """
    _check(baselines, "the set of predictors")
    ordered = {name: baselines[name] for name in KINDS if name in baselines}
    write_arrays(
        path,
        FORM,
        _stored(ordered),
        hash=baselines_hash(ordered),
        facts={name: one.facts for name, one in ordered.items()},
    )


def load_baselines(path: Path | None = None) -> dict[str, Baseline]:
    """Read fitted predictors by name; without a path, those that ship with costeer.

    Raises:
        ValueError: If the file is not of fitted predictors, is of another version, does
            not fit itself or has been altered.
        OSError: If the file cannot be read.
    """
    if path is None:
        folder = resources.files("costeer.intention").joinpath("data")
        return _parsed(folder.joinpath(SHIPPED).read_bytes(), f"the shipped {SHIPPED}")
    return _parsed(read_whole(path), str(path))


def _stored(baselines: Mapping[str, Baseline]) -> Arrays:
    """All arrays by the name they have in the file."""
    found: Arrays = {}
    for name, one in baselines.items():
        for variant, weights in one.variants.items():
            for field, values in weights._asdict().items():
                found[f"{name}/{variant}/{field}"] = _little_endian(values)
    return found


def _little_endian(values: NDArray[Any]) -> NDArray[Any]:
    array = np.asarray(values)
    return np.ascontiguousarray(array, array.dtype.newbyteorder("<"))


def _parsed(content: bytes, source: str) -> dict[str, Baseline]:
    header, arrays = read_arrays(content, FORM, source)
    found = _assembled(arrays, dict(header.get("facts", {})), source)
    _check(found, source)
    if baselines_hash(found) != header.get("hash"):
        raise ValueError(f"{source} was altered: its hash does not fit its numbers")
    return found


def _assembled(
    arrays: Arrays, facts: dict[str, Any], source: str
) -> dict[str, Baseline]:
    """Named tuples from the arrays of the file."""
    fields: dict[str, dict[str, Arrays]] = {}
    for place, values in arrays.items():
        name, variant, field = [*place.split("/"), "", ""][:3]
        fields.setdefault(name, {}).setdefault(variant, {})[field] = values
    _check_names(fields, source)
    return {
        name: Baseline(
            variants={
                variant: _tuple(name, variant, fields[name][variant], source)
                for variant in VARIANTS
                if variant in fields[name]
            },
            facts=dict(facts.get(name, {})),
        )
        for name in KINDS
        if name in fields
    }


def _tuple(name: str, variant: str, fields: Arrays, source: str) -> Any:
    kind = KINDS[name].weights
    wrong = sorted(set(kind._fields) ^ set(fields))
    if wrong:
        raise ValueError(
            f"{name}/{variant} of {source} lacks or should not have {', '.join(wrong)}"
        )
    return kind(**fields)


def _check_names(names: Mapping[str, Mapping[str, Any]], source: str) -> None:
    for name, variants in names.items():
        if name not in KINDS:
            known = ", ".join(KINDS)
            raise ValueError(f"{source} holds {name!r}; known predictors are {known}")
        unknown = [variant for variant in variants if variant not in VARIANTS]
        if unknown or not variants:
            raise ValueError(
                f"{name} of {source} has the variants {', '.join(variants) or 'none'}; "
                f"known ones are {', '.join(VARIANTS)}"
            )


def _check(baselines: Mapping[str, Baseline], source: str) -> None:
    """Refuse unknown names, shapes that do not fit and values that are not finite."""
    _check_names({name: one.variants for name, one in baselines.items()}, source)
    for name, one in baselines.items():
        for variant, weights in one.variants.items():
            shapes = KINDS[name].module.expected_shapes(weights)
            for field, values in weights._asdict().items():
                place = f"{name}/{variant}/{field} of {source}"
                check_array(np.asarray(values), shapes[field], place, TYPES)
