"""Which parameters a fit looks for, which it cannot find in manual driving, and why.

Chosen by the information matrix of the likelihood and by recovery of known drivers,
`benchmarks/driver_recovery.py`; docs/fit.md has the numbers.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.drivers.driver import DriverParameters


class Parameter(NamedTuple):
    """A parameter that the likelihood of the torque is maximised over.

    Attributes:
        name: Part of the driver and field, as in `vision.lead_time`.
        unit: Of the value.
        positive: Whether it is searched on the logarithmic scale.
        low: Smallest value that is searched.
        high: Largest value that is searched.
        tied: Parameters that keep their ratio to this one.
    """

    name: str
    unit: str
    positive: bool
    low: float
    high: float
    tied: tuple[str, ...] = ()


STEERING = (
    Parameter("vision.lead_time", "s", True, 0.1, 15.0),
    Parameter("vision.near_noise", "rad", True, 1e-4, 0.2, ("vision.motor_noise",)),
    Parameter("tracking.wander_deviation", "m", True, 0.005, 2.0),
    Parameter("tracking.lane_bias", "m", False, -1.5, 1.5),
    Parameter("arm.stiffness", "N·m/rad", True, 0.5, 150.0),
    Parameter("arm.damping", "N·m·s/rad", True, 0.005, 10.0),
    Parameter("arm.inertia", "kg·m²", True, 0.002, 2.0),
)
"""The identifiable set of the steering, estimated together."""


class Estimate(NamedTuple):
    """A parameter of the driver, as the recording tells it.

    Attributes:
        name: Part of the driver and field, as in `vision.lead_time`.
        value: Best estimate.
        low: Lower end of the 95 % interval.
        high: Upper end.
        unit: Of all three.
        how: Of the estimate and its interval.
    """

    name: str
    value: float
    low: float
    high: float
    unit: str
    how: str


class NotIdentified(NamedTuple):
    """A parameter that stays at its usual value.

    Attributes:
        name: Of one or more parameters.
        reason: Why a recording of manual driving does not tell.
    """

    name: str
    reason: str


_NO_GUIDANCE = "acts on guidance only; in manual driving nothing depends on it"
_HELD = "held at the usual value: estimated as well, it would have a standard error of"

NOT_IDENTIFIED = (
    NotIdentified("reliance.*", _NO_GUIDANCE),
    NotIdentified(
        "vision.near_gain, vision.far_gain, vision.lag_time",
        f"{_HELD} 33, 19 and 51 % and correlate with lead_time or near_noise by 0.93 "
        "to 0.97; the torque tells little more than gain times lead",
    ),
    NotIdentified(
        "vision.motor_noise by itself",
        f"{_HELD} 33 % and correlate with near_noise by -0.86, as both pass nearly "
        "the same filter; kept in the usual ratio to near_noise",
    ),
    NotIdentified("vision.delay", f"{_HELD} 135 %"),
    NotIdentified(
        "arm.holding_gain, arm.intrinsic_share",
        f"{_HELD} 43 and 23 %: the reflex acts a tenth of a second after the "
        "intrinsic stiffness, and the holding torque adds to the stiffness",
    ),
    NotIdentified(
        "vision.near_time, vision.noise_time, arm.lag, tracking.wander_frequency, "
        "tracking.wander_damping",
        f"{_HELD} 4 to 30 % each, but not all at once: then the information has a "
        "condition number above 1e7",
    ),
    NotIdentified(
        "vision.anticipation_time, vision.curvature_gain",
        "act on a curved path only; lane keeping on a straight road has none",
    ),
    NotIdentified(
        "decision.headway, decision.patience, decision.return_headway",
        "a decision falls some time before anything is seen of it, and a trial has "
        "four of each",
    ),
)
"""What a fit leaves at its usual value, whatever the recording; the numbers are the
medians of `benchmarks/driver_recovery.py --seed 31`."""


def value_of(driver: DriverParameters, name: str) -> float:
    """The value of a parameter by its dotted name."""
    group, field = name.split(".")
    return float(getattr(getattr(driver, group), field))


def with_value(driver: DriverParameters, name: str, value: float) -> DriverParameters:
    """The driver with another value of the parameter with this dotted name."""
    group, field = name.split(".")
    changed = getattr(driver, group)._replace(**{field: value})
    return driver._replace(**{group: changed})


def with_parameter(
    driver: DriverParameters, parameter: Parameter, value: float
) -> DriverParameters:
    """The driver with another value of a parameter and of those that are tied to it."""
    ratio = value / value_of(driver, parameter.name) if parameter.tied else 1.0
    for name in parameter.tied:
        driver = with_value(driver, name, ratio * value_of(driver, name))
    return with_value(driver, parameter.name, value)


def coordinates(
    driver: DriverParameters, parameters: Sequence[Parameter]
) -> NDArray[np.float64]:
    """Where the driver is on the scale that is searched, shape `(parameter,)`."""
    values = [value_of(driver, p.name) for p in parameters]
    return np.array(
        [
            np.log(v) if p.positive else v
            for p, v in zip(parameters, values, strict=True)
        ]
    )


def natural(parameters: Sequence[Parameter], point: NDArray[np.float64]) -> list[float]:
    """Values of the parameters at a point of the scale that is searched."""
    return [
        float(np.exp(x) if p.positive else x)
        for p, x in zip(parameters, point, strict=True)
    ]


def driver_at(
    driver: DriverParameters,
    parameters: Sequence[Parameter],
    point: NDArray[np.float64],
) -> DriverParameters:
    """The driver with the parameters of a point of the scale that is searched."""
    for parameter, value in zip(parameters, natural(parameters, point), strict=True):
        driver = with_parameter(driver, parameter, value)
    return driver
