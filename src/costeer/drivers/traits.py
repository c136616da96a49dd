"""What differs between virtual drivers, and what goes together.

A driver is a vector of correlated standard normal traits, drawn by seed and number.
"""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.base.array import Real

_POPULATION_STREAM = 0


class Traits(NamedTuple):
    """What differs between drivers, each standard normal over the population.

    Attributes:
        noise: Of seeing and steering.
        lead_time: Of the near point's lead.
        wander: Of the aim.
        lane_bias: Preferred place in the lane.
        stiffness: Of the arms.
        arm_inertia: Of the arms.
        arm_damping: Of the arms.
        reliance: On guidance that agrees.
        cocontraction: Against guidance that opposes.
        duration: Of planned lane changes.
        headway: At which overtaking is decided, and at which the return is.
        patience: Behind a leader who is hardly slower.
        shoulder: Share of looks over the shoulder.
        glance: Size of glances.
        preferred_speed: Against the suggested one.
        overtaking_speed: Speeding up to overtake.
    """

    noise: Real
    lead_time: Real
    wander: Real
    lane_bias: Real
    stiffness: Real
    arm_inertia: Real
    arm_damping: Real
    reliance: Real
    cocontraction: Real
    duration: Real
    headway: Real
    patience: Real
    shoulder: Real
    glance: Real
    preferred_speed: Real
    overtaking_speed: Real


class Factor(NamedTuple):
    """What several traits have in common.

    Two traits of a factor are correlated by the product of their loadings; traits
    without a common factor are independent.

    Attributes:
        name: Of the factor.
        loadings: Names of traits and their correlation with the factor [-].
        source: Where it is from, or why it is assumed.
    """

    name: str
    loadings: dict[str, Real]
    source: str


FACTORS = (
    Factor(
        name="style",
        loadings={
            "preferred_speed": 0.5,
            "overtaking_speed": 0.5,
            "headway": -0.6,
            "duration": -0.4,
            "patience": -0.4,
            "shoulder": -0.3,
        },
        source="Itkonen et al. (2017): one axis from calm to intensive driving; "
        "loadings assumed",
    ),
    Factor(
        name="arms",
        loadings={"arm_inertia": 0.6, "arm_damping": 0.7, "stiffness": 0.6},
        source="assumed: all three grow with the arms and their activation",
    ),
    Factor(
        name="trust",
        loadings={"reliance": 0.55, "cocontraction": -0.55},
        source="assumed: who leaves more to the guidance stiffens less against it",
    ),
)
"""Traits that go together. Noise and wander do not: standard deviation of lane
position and steering activity are hardly correlated between drivers."""


@cache
def loadings() -> NDArray[np.float64]:
    """Loadings of the traits on the factors, shape `(trait, factor)`."""
    matrix = np.zeros((len(Traits._fields), len(FACTORS)))
    for column, factor in enumerate(FACTORS):
        for name, loading in factor.loadings.items():
            matrix[Traits._fields.index(name), column] = loading
    return matrix


def correlation_matrix() -> NDArray[np.float64]:
    """Correlations of the traits, shape `(trait, trait)`."""
    common = loadings() @ loadings().T
    return np.asarray(common + np.diag(1.0 - np.diag(common)), dtype=np.float64)


def drawn_traits(seed: int, participant: int) -> Traits:
    """Traits of the driver with this number.

    Args:
        seed: Of the population; other seeds are other people.
        participant: Number of the driver.
    """
    entropy = [seed, _POPULATION_STREAM, participant]
    generator = np.random.Generator(np.random.PCG64(np.random.SeedSequence(entropy)))
    own = generator.standard_normal(len(Traits._fields))
    common = generator.standard_normal(len(FACTORS))
    explained = np.sum(loadings() ** 2, axis=1)
    mixed = np.sqrt(1.0 - explained) * own + loadings() @ common
    return Traits(*mixed.tolist())
