"""Annotated shapes are checked while the tests run, in every module that has them."""

from __future__ import annotations

import numpy as np
import pytest
from jaxtyping import TypeCheckError

from costeer.study.repeated import greenhouse_geisser
from costeer.study.ttests import paired_t_test
from costeer.training.metrics import brier, pr_auc
from tests.architecture.source import PACKAGE, files
from tests.shapes import MODULES


def test_every_module_with_shapes_is_checked() -> None:
    names = [
        ".".join(("costeer", *file.relative_to(PACKAGE).with_suffix("").parts))
        for file in files()
        if "from jaxtyping import" in file.read_text("utf-8")
    ]
    assert names == sorted(MODULES)


def test_a_wrong_shape_is_refused() -> None:
    with pytest.raises(TypeCheckError):
        brier(np.zeros(3), np.zeros(4, dtype=bool))
    with pytest.raises(TypeCheckError):
        pr_auc(np.zeros((2, 5)), np.zeros((3, 5)))
    with pytest.raises(TypeCheckError):
        paired_t_test(np.zeros(3), np.zeros(4))


def test_a_wrong_number_of_axes_or_kind_is_refused() -> None:
    with pytest.raises(TypeCheckError):
        greenhouse_geisser(np.zeros(3))
    with pytest.raises(TypeCheckError):
        greenhouse_geisser(np.zeros((3, 2), dtype=int))
