"""The population of virtual drivers: how they differ, drawn by seed and participant.

Calibrated on manual driving only (docs/decisions/0009-drivers-frozen.md). Positive
quantities are log-normal in their trait, shares and signed quantities normal and
clipped.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from costeer.base.array import Real
from costeer.drivers.arm import ArmParameters
from costeer.drivers.correcting import CorrectingParameters
from costeer.drivers.driver import DriverParameters, act, initial_state
from costeer.drivers.evasion import EvasionParameters
from costeer.drivers.gaze import GazeParameters
from costeer.drivers.interface import AnyDriver, Draw, DriverModel
from costeer.drivers.learning import LearningParameters
from costeer.drivers.longitudinal import LongitudinalParameters
from costeer.drivers.overtaking import DecisionParameters
from costeer.drivers.reliance import RelianceParameters
from costeer.drivers.tolerance import ToleranceParameters
from costeer.drivers.tracking import TrackingParameters
from costeer.drivers.traits import Traits, drawn_traits
from costeer.drivers.vision import VisionParameters
from costeer.drivers.whole import DriverState

VirtualDriver = DriverModel[DriverParameters, DriverState]

POPULATION_VERSION = "3"
"""Changes when a parameter, a spread or a correlation of the drivers does."""

_EVASION_STREAM = 8

PILOT_SEED = 900_001
"""Seed of the pilot drivers that set the inconsistency threshold δ."""

REACTION_SPREAD = 0.25
"""Standard deviation of the logarithm of reaction times between drivers [-]. Source:
assumed."""

FASTEST_REACTION = 0.3
"""Shortest reaction time [s]. Source: spec section 12."""


class PopulationParameters(NamedTuple):
    """Spreads between drivers.

    `_spread` is the standard deviation of the logarithm for positive quantities, the
    standard deviation itself for the others.

    Attributes:
        wander_deviation_spread: Of `wander_deviation` [-]. Source: assumed,
            calibrated on the spread of manual SDLP between drivers.
        band_spread: Of the tolerance's `band`, with the wander's trait [-]. Source:
            assumed, as above.
        lane_bias_spread: Of `lane_bias` [m]. Source: assumed.
        near_noise_spread: Of `near_noise` and `motor_noise` [-]. Source: assumed,
            calibrated on manual reversal rates.
        lead_time_spread: Of `lead_time` [s], clipped to 1 to 2.5. Source: Saleh et
            al. (2013), range.
        stiffness_spread: Of the arm's stiffness [-], clipped to 8 to 20 N·m/rad.
            Source: Saleh et al. (2013), range.
        arm_spread: Of the arms' inertia and damping [-]. Source: assumed, people's
            size.
        reliance_spread: Of `reliance` [-]. Source: assumed.
        cocontraction_spread: Of `cocontraction` [-], clipped to 1.5 to 3. Source:
            assumed.
        duration_spread: Of the driver's median planned duration [-]. Source:
            assumed, calibrated on durations of lane changes.
        headway_spread: Of the headways at which overtaking and return are decided
            [-]. Source: assumed.
        patience_spread: Of the patience behind a leader [-]. Source: assumed.
        shoulder_spread: Of the share of looks over the shoulder [-]. Source: assumed.
        preferred_speed_spread: Of the preferred speed [m/s]. Source: assumed.
        overtaking_speed_spread: Of the speeding up [m/s]. Source: assumed.
        glance_spread: Of glance amplitude [-]. Source: assumed.
    """

    wander_deviation_spread: Real = 0.22
    band_spread: Real = 0.22
    lane_bias_spread: Real = 0.05
    near_noise_spread: Real = 0.2
    lead_time_spread: Real = 0.3
    stiffness_spread: Real = 0.2
    arm_spread: Real = 0.15
    reliance_spread: Real = 0.2
    cocontraction_spread: Real = 0.2
    duration_spread: Real = 0.1
    headway_spread: Real = 0.12
    patience_spread: Real = 0.4
    shoulder_spread: Real = 0.15
    preferred_speed_spread: Real = 0.8
    overtaking_speed_spread: Real = 1.0
    glance_spread: Real = 0.1


SIMULATOR, TRAFFIC = "simulator", "traffic"
"""Domains of driving: a fixed base, as in the paper's study, and real roads."""


class Population(NamedTuple):
    """People of one kind.

    Attributes:
        name: Of the driver model: small letters, digits, hyphens.
        version: Changes when a parameter, a spread or a correlation does.
        domain: Where lane changes last as long as these drivers'.
        usual: The driver without any trait.
        spreads: Between drivers.
    """

    name: str
    version: str
    domain: str = SIMULATOR
    usual: DriverParameters = DriverParameters()
    spreads: PopulationParameters = PopulationParameters()


USUAL = Population(name="virtual", version=POPULATION_VERSION)
"""The population that ships with costeer, in a driving simulator."""

_IN_TRAFFIC = USUAL.usual.decision._replace(
    change_duration=7.2, change_duration_spread=0.17
)

ON_THE_ROAD = Population(
    name="virtual-traffic",
    version=POPULATION_VERSION,
    domain=TRAFFIC,
    usual=USUAL.usual._replace(decision=_IN_TRAFFIC),
    spreads=PopulationParameters(duration_spread=0.16),
)
"""The same drivers on real roads, where lane changes take longer and vary more."""

SECOND = Population(
    name="virtual-2",
    version="2",
    domain=TRAFFIC,
    usual=DriverParameters(
        vision=VisionParameters(near_noise=0.008, motor_noise=0.0095, signal_noise=0.0),
        reliance=RelianceParameters(leading_horizon=0.0),
        tracking=TrackingParameters(wander_deviation=0.19),
        correcting=CorrectingParameters(evidence_rate=0.0),
        learning=LearningParameters(share=0.0, before=0.0),
        tolerance=ToleranceParameters(band=0.0),
        decision=_IN_TRAFFIC,
    ),
    spreads=PopulationParameters(
        wander_deviation_spread=0.18, band_spread=0.0, duration_spread=0.16
    ),
)
"""The population before: it plans once, pursues its aim and learns nothing, which makes
it the one that can be identified from a recording."""

POPULATIONS = {each.name: each for each in (USUAL, ON_THE_ROAD, SECOND)}
"""All that can be chosen, by name."""


def _positive(median: Real, spread: Real, trait: Real) -> Real:
    """Log-normal with this median."""
    return float(median * np.exp(spread * trait))


def _between(mean: Real, spread: Real, trait: Real, low: Real, high: Real) -> Real:
    """Normal, clipped."""
    return float(np.clip(mean + spread * trait, low, high))


def participant_driver(
    seed: int,
    participant: int,
    speed: Real,
    population: Population = USUAL,
) -> DriverParameters:
    """Return the driver with this number.

    Args:
        seed: Of the population; other seeds are other people.
        participant: Number of the driver.
        speed: Suggested speed [m/s].
        population: Who is drawn from.
    """
    drawn = driver_with(drawn_traits(seed, participant), speed, population)
    usual = population.usual.evasion
    return drawn._replace(evasion=_evasion(usual, seed, participant))


def _evasion(
    usual: EvasionParameters, seed: int, participant: int
) -> EvasionParameters:
    """How this driver meets an emergency; drawn apart from all other traits."""
    entropy = [seed, _EVASION_STREAM, participant]
    generator = np.random.Generator(np.random.PCG64(np.random.SeedSequence(entropy)))
    trait = float(generator.standard_normal())
    reaction = _positive(usual.reaction_time, REACTION_SPREAD, trait)
    return usual._replace(reaction_time=max(reaction, FASTEST_REACTION))


def driver_with(
    traits: Traits, speed: Real, population: Population = USUAL
) -> DriverParameters:
    """Return the driver who has these traits.

    Args:
        traits: 0 for the usual driver, 1 for one standard deviation more.
        speed: Suggested speed [m/s].
        population: Who is drawn from.
    """
    usual, spread = population.usual, population.spreads
    return usual._replace(
        vision=_vision(usual.vision, traits, spread),
        arm=_arm(usual.arm, traits, spread),
        reliance=_reliance(usual.reliance, traits, spread),
        tracking=_tracking(usual.tracking, traits, spread),
        decision=_decision(usual.decision, traits, spread),
        gaze=_gaze(usual.gaze, traits, spread),
        longitudinal=_longitudinal(usual.longitudinal, traits, spread, speed),
        tolerance=usual.tolerance._replace(
            band=_positive(usual.tolerance.band, spread.band_spread, traits.wander)
        ),
    )


def _vision(
    usual: VisionParameters, traits: Traits, spread: PopulationParameters
) -> VisionParameters:
    noise = _positive(1.0, spread.near_noise_spread, traits.noise)
    return usual._replace(
        near_noise=usual.near_noise * noise,
        motor_noise=usual.motor_noise * noise,
        lead_time=_between(
            usual.lead_time, spread.lead_time_spread, traits.lead_time, 1.0, 2.5
        ),
    )


def _arm(
    usual: ArmParameters, traits: Traits, spread: PopulationParameters
) -> ArmParameters:
    stiffness = _positive(usual.stiffness, spread.stiffness_spread, traits.stiffness)
    return usual._replace(
        stiffness=float(np.clip(stiffness, 8.0, 20.0)),
        inertia=_positive(usual.inertia, spread.arm_spread, traits.arm_inertia),
        damping=_positive(usual.damping, spread.arm_spread, traits.arm_damping),
    )


def _reliance(
    usual: RelianceParameters, traits: Traits, spread: PopulationParameters
) -> RelianceParameters:
    tense = _positive(
        usual.cocontraction, spread.cocontraction_spread, traits.cocontraction
    )
    return usual._replace(
        reliance=_between(
            usual.reliance, spread.reliance_spread, traits.reliance, 0.0, 1.0
        ),
        cocontraction=float(np.clip(tense, 1.5, 3.0)),
    )


def _tracking(
    usual: TrackingParameters, traits: Traits, spread: PopulationParameters
) -> TrackingParameters:
    return usual._replace(
        wander_deviation=_positive(
            usual.wander_deviation, spread.wander_deviation_spread, traits.wander
        ),
        lane_bias=_between(
            usual.lane_bias, spread.lane_bias_spread, traits.lane_bias, -0.2, 0.2
        ),
    )


def _decision(
    usual: DecisionParameters, traits: Traits, spread: PopulationParameters
) -> DecisionParameters:
    room = _positive(1.0, spread.headway_spread, traits.headway)
    return usual._replace(
        change_duration=_positive(
            usual.change_duration, spread.duration_spread, traits.duration
        ),
        headway=usual.headway * room,
        return_headway=usual.return_headway * room,
        patience=_positive(usual.patience, spread.patience_spread, traits.patience),
        shoulder_share=_between(
            usual.shoulder_share,
            spread.shoulder_spread,
            traits.shoulder,
            0.0,
            usual.glance_share,
        ),
    )


def _gaze(
    usual: GazeParameters, traits: Traits, spread: PopulationParameters
) -> GazeParameters:
    return usual._replace(
        amplitude=_positive(usual.amplitude, spread.glance_spread, traits.glance)
    )


def _longitudinal(
    usual: LongitudinalParameters,
    traits: Traits,
    spread: PopulationParameters,
    speed: Real,
) -> LongitudinalParameters:
    faster = _between(
        usual.overtaking_speed,
        spread.overtaking_speed_spread,
        traits.overtaking_speed,
        0.0,
        5.0,
    )
    preferred = _between(
        speed,
        spread.preferred_speed_spread,
        traits.preferred_speed,
        0.8 * speed,
        1.2 * speed,
    )
    return usual._replace(preferred_speed=preferred, overtaking_speed=faster)


def check_study_seed(seed: int) -> None:
    """Refuse the pilot drivers as participants: δ was tuned on them.

    Raises:
        ValueError: If it is their seed.
    """
    if seed == PILOT_SEED:
        raise ValueError(
            f"seed {seed} is that of the pilot drivers, on whom the inconsistency "
            "threshold was set; give another seed"
        )


def hands_off(speed: Real) -> DriverParameters:
    """A driver who only holds `speed` [m/s]: no hands, no decisions, no glances."""
    return DriverParameters(
        arm=ArmParameters(hands_on=0.0),
        decision=DecisionParameters(decides=0.0),
        gaze=GazeParameters(false_rate=0.0, drift_deviation=0.0),
        longitudinal=LongitudinalParameters(preferred_speed=speed, speed_deviation=0.0),
    )


def _model(population: Population) -> VirtualDriver:
    """The population as a driver model; all of them follow one law."""

    def drawn(draw: Draw) -> DriverParameters:
        return participant_driver(draw.seed, draw.participant, draw.speed, population)

    return DriverModel(
        name=population.name,
        version=population.version,
        source="Saleh et al. (2013), with what docs/drivers.md adds",
        parameters=drawn,
        initial_state=initial_state,
        act=act,
    )


MODELS = {name: _model(population) for name, population in POPULATIONS.items()}
"""The populations as driver models, by name."""

VIRTUAL = MODELS[USUAL.name]
"""The population that ships with costeer."""


def population_of(driver: AnyDriver) -> Population | None:
    """The population that a driver model is; None if somebody else made it."""
    ours = MODELS.get(driver.name)
    return POPULATIONS[driver.name] if driver is ours else None
