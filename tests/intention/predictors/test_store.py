"""The file of fitted predictors: whole, the same bytes, and picky."""

from __future__ import annotations

import io
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from costeer.intention.predictors import registry
from costeer.intention.predictors.registry import (
    PREDICTORS,
    fitted_predictor,
    predictor,
)
from costeer.intention.predictors.store import (
    Baseline,
    baselines_hash,
    load_baselines,
    save_baselines,
)
from tests.intention.predictors.made import baselines, features, line_time


@pytest.fixture
def saved(tmp_path: Path) -> Path:
    path = tmp_path / "baselines.npz"
    save_baselines(path, baselines())
    return path


def altered(path: Path, **changes: Any) -> Path:
    """The file with some arrays replaced, None to leave one out."""
    with np.load(path) as archive:
        arrays = {name: archive[name] for name in archive.files}
    arrays |= changes
    kept = {name: value for name, value in arrays.items() if value is not None}
    buffer = io.BytesIO()
    np.savez(buffer, **kept)
    path.write_bytes(buffer.getvalue())
    return path


def with_header(path: Path, **changes: Any) -> Path:
    with np.load(path) as archive:
        header = json.loads(archive["header"].tobytes())
    text = json.dumps(header | changes).encode()
    return altered(path, header=np.frombuffer(text, np.uint8))


def test_what_is_saved_comes_back(saved: Path) -> None:
    made, found = baselines(), load_baselines(saved)
    assert list(found) == list(made)
    assert baselines_hash(found) == baselines_hash(made)
    seen = features(220, 1)
    for name, one in made.items():
        assert found[name].facts == one.facts
        np.testing.assert_array_equal(
            fitted_predictor(name, found[name]).probabilities(seen, ()),
            fitted_predictor(name, one).probabilities(seen, ()),
        )


def test_the_same_numbers_give_the_same_bytes(saved: Path, tmp_path: Path) -> None:
    other = tmp_path / "other.npz"
    save_baselines(other, dict(reversed(baselines().items())))
    assert other.read_bytes() == saved.read_bytes()


def test_a_change_of_one_number_is_seen(saved: Path) -> None:
    name = "line-time/motion/slope"
    with pytest.raises(ValueError, match="was altered"):
        load_baselines(altered(saved, **{name: np.array([-2.1])}))


BAD: list[tuple[dict[str, Any], str]] = [
    ({"line-time/motion/slope": np.zeros(2)}, "has the shape"),
    ({"line-time/motion/slope": np.array([np.nan])}, "not finite"),
    ({"line-time/motion/slope": np.array(["x"])}, "expected one of"),
    ({"line-time/motion/slope": None}, "lacks or should not have slope"),
    ({"line-time/motion/more": np.zeros(1)}, "lacks or should not have more"),
    ({"line-time/boat/slope": np.zeros(1)}, "variants motion, boat"),
    ({"oracle/full/slope": np.zeros(1)}, "'oracle'; known predictors are line-time"),
    ({"header": None}, "is not a file of fitted predictors"),
    ({"head-only/head/number_scale": np.zeros(20)}, "not positive"),
]


@pytest.mark.parametrize(("changes", "message"), BAD, ids=[m for _, m in BAD])
def test_a_file_that_does_not_fit_is_refused(
    saved: Path, changes: dict[str, Any], message: str
) -> None:
    with pytest.raises(ValueError, match=message):
        load_baselines(altered(saved, **changes))


def test_other_versions_and_signals_are_refused(saved: Path) -> None:
    with pytest.raises(ValueError, match="version 7"):
        load_baselines(with_header(saved, version=7))
    with pytest.raises(ValueError, match="for the signals"):
        load_baselines(with_header(saved, version=1, features=["eye"]))


def test_what_is_no_such_file_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "text.npz"
    path.write_text("hello")
    with pytest.raises(ValueError, match=r"text\.npz is not a file of fitted"):
        load_baselines(path)


def test_nonsense_is_not_saved(tmp_path: Path) -> None:
    path = tmp_path / "new.npz"
    bad = Baseline({"motion": line_time()._replace(slope=np.array([np.inf]))}, {})
    with pytest.raises(ValueError, match="not finite"):
        save_baselines(path, {"line-time": bad})
    with pytest.raises(ValueError, match="variants none"):
        save_baselines(path, {"line-time": Baseline({}, {})})
    assert not path.exists()


def test_predictors_come_by_name(saved: Path) -> None:
    assert PREDICTORS[0] == "line-time"
    assert PREDICTORS[-2:] == ("paper-gru", "gru")
    for name in PREDICTORS[:-1]:
        one = predictor(name, saved)
        assert one.name == name
        assert one.title
        assert one.source
    assert set(registry.TITLES) == set(registry.NEEDS) == set(PREDICTORS)


def test_an_unknown_name_is_told_with_the_known_ones(saved: Path) -> None:
    with pytest.raises(ValueError, match=r"'crystal-ball'; known are line-time, logis"):
        predictor("crystal-ball")
    with pytest.raises(ValueError, match="none of the fits"):
        fitted_predictor("gru", baselines()["paper-gru"])
    save_baselines(saved, {"line-time": baselines()["line-time"]})
    with pytest.raises(ValueError, match=r"holds no fitted 'logistic'; it holds line-"):
        predictor("logistic", saved)
