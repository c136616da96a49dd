"""The check of annotated shapes that runs in every test, by jaxtyping and beartype."""

from __future__ import annotations

from beartype import BeartypeConf, beartype
from jaxtyping import install_import_hook

MODULES = (
    "costeer.intention.gru",
    "costeer.study.anova",
    "costeer.study.lane_keeping",
    "costeer.study.mixed",
    "costeer.study.ranks",
    "costeer.study.repeated",
    "costeer.study.reversals",
    "costeer.study.rounding",
    "costeer.study.ttests",
    "costeer.training.bootstrap",
    "costeer.training.calibration",
    "costeer.training.labels",
    "costeer.training.metrics",
    "costeer.training.operating",
)
"""Modules whose array arguments are checked; only such as Numba does not compile."""

check = beartype(conf=BeartypeConf(is_pep484_tower=True))
"""Beartype, to whom a whole number is a float, as it is to mypy."""


def check_shapes() -> None:
    """Check from now on; call it before any of the modules is imported."""
    install_import_hook(MODULES, f"{__name__}.check")
