"""Rows are written out from declarations, and say the same in every engine."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numba
import numpy as np
import pytest

from costeer.records.columns import Column
from costeer.records.row import record_columns, row_writer


class Rival(NamedTuple):
    """State of a method that nobody has."""

    integral: float
    armed: bool
    history: np.ndarray  # type: ignore[type-arg]


class Group(NamedTuple):
    """What another stage says."""

    torque: float
    method: Rival


class Made(NamedTuple):
    """A sample of a loop that nobody has."""

    time: float
    inner: Group
    method: Rival


RIVAL = Rival(integral=-0.25, armed=True, history=np.zeros(3))
SAMPLE = Made(time=1.5, inner=Group(torque=2.0, method=RIVAL), method=RIVAL)


def column(source: str, name: str = "method_new", **more: Any) -> Column:
    return Column(name, "-", "float64", "made up", source, **more)


COLUMNS = (
    column("time"),
    column("method.armed"),
    column("inner.torque"),
    column("inner.method.integral"),
)
ROW = [1.5, 1.0, 2.0, -0.25]


def test_a_row_holds_the_places_in_the_order_of_the_columns() -> None:
    out = np.zeros(4)
    row_writer(COLUMNS, SAMPLE).fill(out, SAMPLE)
    assert out.tolist() == ROW


def test_compiled_code_fills_the_same_row() -> None:
    fill = row_writer(COLUMNS, SAMPLE).fill

    @numba.njit
    def called(out: np.ndarray, sample: Made) -> None:  # type: ignore[type-arg]
        fill(out, sample)

    out = np.zeros(4)
    called(out, SAMPLE)
    assert out.tolist() == ROW


def test_traced_code_gets_the_same_numbers() -> None:
    jax = pytest.importorskip("jax")
    values = row_writer(COLUMNS, SAMPLE).values
    traced = jax.jit(values)(SAMPLE)
    assert [float(value) for value in traced] == ROW


def test_two_lists_of_columns_are_two_functions_to_a_cache() -> None:
    one, other = row_writer(COLUMNS, SAMPLE), row_writer(COLUMNS[:2], SAMPLE)
    assert one.fill.__qualname__ != other.fill.__qualname__
    again = row_writer(COLUMNS, SAMPLE)
    assert one.fill.__qualname__ == again.fill.__qualname__


@pytest.mark.parametrize(
    ("source", "message"),
    [
        (
            "speed",
            "no 'speed' in the sample; the sample has no 'speed', it is time, in",
        ),
        ("inner.gain", "'inner' has no 'gain', it is torque, method"),
        ("time.zone", "'time' has no 'zone', it is a number and no more"),
        ("", "the sample has no ''"),
        ("method", "'method' is no number, it is integral, armed, history"),
        ("method.history", "'method.history' is no number, it is an array"),
    ],
)
def test_a_place_that_is_not_there_names_the_column_and_what_there_is(
    source: str, message: str
) -> None:
    with pytest.raises(ValueError, match=f"column 'method_new': .*{message}"):
        row_writer([column(source)], SAMPLE)


def test_rows_become_columns_in_the_kind_that_is_declared() -> None:
    kinds = (
        column("", "method_number"),
        column("", "method_count", nullable=True)._replace(kind="int8"),
        column("", "method_flag")._replace(kind="bool"),
        column("", "method_word", labels=("off", "on"))._replace(kind="string"),
    )
    rows = np.array([[0.5, math.nan, 1.0, 1.0], [math.nan, -3.0, 0.0, 0.0]])
    number, count, flag, word = record_columns(rows, True, kinds).values()
    np.testing.assert_array_equal(number, [0.5, math.nan])
    assert count.tolist() == [None, -3]
    assert flag.tolist() == [True, False]
    assert word.tolist() == ["on", "off"]


def test_what_assistance_alone_has_is_empty_in_the_rows_without_it() -> None:
    kinds = (
        column("", "method_kept"),
        column("", "method_number", assisted_only=True),
        column("", "method_count", assisted_only=True, nullable=True)._replace(
            kind="int8"
        ),
        column("", "method_word", assisted_only=True, labels=("off", "on"))._replace(
            kind="string"
        ),
    )
    made = record_columns(np.ones((2, 4)), np.array([True, False]), kinds)
    kept, number, count, word = made.values()
    np.testing.assert_array_equal(kept, [1.0, 1.0])
    np.testing.assert_array_equal(number, [1.0, math.nan])
    assert count.tolist() == [1, None]
    assert word.tolist() == ["on", "off"]


@pytest.mark.parametrize("code", [2.0, -1.0, math.nan])
def test_a_number_without_a_label_is_refused(code: float) -> None:
    word = column("", "method_word", labels=("off", "on"))._replace(kind="string")
    with pytest.raises(
        ValueError, match=r"'method_word' is .* in row 1; its labels are"
    ):
        record_columns(np.array([[0.0], [code]]), True, [word])


def test_a_number_that_does_not_fit_is_refused() -> None:
    counter = Column("method_count", "-", "int8", "of something", "count")
    with pytest.raises(ValueError, match=r"'method_count' is 305 in row 1; int8 holds"):
        record_columns(np.array([[127.0], [305.0]]), True, [counter])
