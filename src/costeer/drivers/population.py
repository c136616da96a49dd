"""The population of virtual drivers: how they differ, drawn by seed and participant.

Calibrated on manual driving only (docs/decisions/0005-drivers.md). Positive
quantities are log-normal, shares are normal and clipped.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from costeer.base.array import Real
from costeer.drivers.arm import ArmParameters
from costeer.drivers.decision import DecisionParameters
from costeer.drivers.driver import DriverParameters
from costeer.drivers.gaze import GazeParameters
from costeer.drivers.longitudinal import LongitudinalParameters
from costeer.drivers.reliance import RelianceParameters
from costeer.drivers.tracking import TrackingParameters
from costeer.drivers.vision import VisionParameters

POPULATION_VERSION = "1"
"""Changes when a parameter or a spread of the drivers does."""

_POPULATION_STREAM = 0


class PopulationParameters(NamedTuple):
    """Medians and spreads between drivers.

    `_spread` is the standard deviation of the logarithm for positive quantities, the
    standard deviation itself for the others.

    Attributes:
        wander_deviation_spread: Of `wander_deviation` [-]. Source: assumed,
            calibrated on the spread of manual SDLP between drivers.
        lane_bias_spread: Of `lane_bias` [m]. Source: assumed.
        near_noise_spread: Of `near_noise` and `motor_noise` [-]. Source: assumed,
            calibrated on manual reversal rates.
        lead_time_spread: Of `lead_time` [s], clipped to 1 to 2.5. Source: Saleh et
            al. (2013), range.
        stiffness_spread: Of the arm's stiffness [-], clipped to 8 to 20 N·m/rad.
            Source: Saleh et al. (2013), range.
        reliance_spread: Of `reliance` [-]. Source: assumed.
        cocontraction_spread: Of `cocontraction` [-], clipped to 1.5 to 3. Source:
            assumed.
        duration_spread: Of the driver's median planned duration [-]. Source:
            assumed, calibrated on durations of real lane changes.
        headway_spread: Of the headway of decision [-]. Source: assumed.
        preferred_speed_spread: Of the preferred speed [m/s]. Source: assumed.
        overtaking_speed_spread: Of the speeding up [m/s]. Source: assumed.
        glance_spread: Of glance amplitude [-]. Source: assumed.
    """

    wander_deviation_spread: Real = 0.18
    lane_bias_spread: Real = 0.05
    near_noise_spread: Real = 0.2
    lead_time_spread: Real = 0.3
    stiffness_spread: Real = 0.2
    reliance_spread: Real = 0.2
    cocontraction_spread: Real = 0.2
    duration_spread: Real = 0.16
    headway_spread: Real = 0.12
    preferred_speed_spread: Real = 0.8
    overtaking_speed_spread: Real = 1.0
    glance_spread: Real = 0.1


class _Draw:
    """Draws around medians from one generator, in a fixed order."""

    def __init__(self, generator: np.random.Generator) -> None:
        self._generator = generator

    def positive(self, median: Real, spread: Real) -> Real:
        """Log-normal with this median."""
        return float(median * np.exp(spread * self._generator.standard_normal()))

    def between(self, mean: Real, spread: Real, low: Real, high: Real) -> Real:
        """Normal, clipped."""
        value = mean + spread * self._generator.standard_normal()
        return float(np.clip(value, low, high))


def participant_driver(
    seed: int,
    participant: int,
    speed: Real,
    population: PopulationParameters | None = None,
) -> DriverParameters:
    """Return the driver with this number.

    Args:
        seed: Of the population; other seeds are other people.
        participant: Number of the driver.
        speed: Suggested speed [m/s].
        population: Spreads between drivers.
    """
    spread = population or PopulationParameters()
    entropy = [seed, _POPULATION_STREAM, participant]
    draw = _Draw(np.random.Generator(np.random.PCG64(np.random.SeedSequence(entropy))))
    return DriverParameters(
        vision=_vision(draw, spread),
        arm=_arm(draw, spread),
        reliance=_reliance(draw, spread),
        tracking=_tracking(draw, spread),
        decision=_decision(draw, spread),
        gaze=_gaze(draw, spread),
        longitudinal=_longitudinal(draw, spread, speed),
    )


def _vision(draw: _Draw, spread: PopulationParameters) -> VisionParameters:
    usual = VisionParameters()
    noise = draw.positive(1.0, spread.near_noise_spread)
    return usual._replace(
        near_noise=usual.near_noise * noise,
        motor_noise=usual.motor_noise * noise,
        lead_time=draw.between(usual.lead_time, spread.lead_time_spread, 1.0, 2.5),
    )


def _arm(draw: _Draw, spread: PopulationParameters) -> ArmParameters:
    usual = ArmParameters()
    stiffness = draw.positive(usual.stiffness, spread.stiffness_spread)
    return usual._replace(stiffness=float(np.clip(stiffness, 8.0, 20.0)))


def _reliance(draw: _Draw, spread: PopulationParameters) -> RelianceParameters:
    usual = RelianceParameters()
    tense = draw.positive(usual.cocontraction, spread.cocontraction_spread)
    return usual._replace(
        reliance=draw.between(usual.reliance, spread.reliance_spread, 0.0, 1.0),
        cocontraction=float(np.clip(tense, 1.5, 3.0)),
    )


def _tracking(draw: _Draw, spread: PopulationParameters) -> TrackingParameters:
    usual = TrackingParameters()
    return usual._replace(
        wander_deviation=draw.positive(
            usual.wander_deviation, spread.wander_deviation_spread
        ),
        lane_bias=draw.between(usual.lane_bias, spread.lane_bias_spread, -0.2, 0.2),
    )


def _decision(draw: _Draw, spread: PopulationParameters) -> DecisionParameters:
    usual = DecisionParameters()
    return usual._replace(
        change_duration=draw.positive(usual.change_duration, spread.duration_spread),
        headway=draw.positive(usual.headway, spread.headway_spread),
        return_distance=draw.positive(usual.return_distance, spread.headway_spread),
    )


def _gaze(draw: _Draw, spread: PopulationParameters) -> GazeParameters:
    usual = GazeParameters()
    return usual._replace(
        amplitude=draw.positive(usual.amplitude, spread.glance_spread)
    )


def _longitudinal(
    draw: _Draw, spread: PopulationParameters, speed: Real
) -> LongitudinalParameters:
    usual = LongitudinalParameters()
    faster = draw.between(
        usual.overtaking_speed, spread.overtaking_speed_spread, 0.0, 5.0
    )
    preferred = draw.between(
        speed, spread.preferred_speed_spread, 0.8 * speed, 1.2 * speed
    )
    return usual._replace(preferred_speed=preferred, overtaking_speed=faster)


def hands_off(speed: Real) -> DriverParameters:
    """A driver who only holds `speed` [m/s]: no hands, no decisions, no glances."""
    return DriverParameters(
        arm=ArmParameters(hands_on=0.0),
        decision=DecisionParameters(decides=0.0),
        gaze=GazeParameters(false_rate=0.0, drift_deviation=0.0),
        longitudinal=LongitudinalParameters(preferred_speed=speed, speed_deviation=0.0),
    )
