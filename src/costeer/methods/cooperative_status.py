"""Gain by cooperative status: Nishimura, Wada, Sugiyama 2015 (arXiv 1504.05770).

Lane keeping that watches two things: who holds the initiative, seen in the pseudo-power
of each (torque times lateral velocity), and whether both mean the same, seen in the
signs of the torques. Where the driver leads and means something else, the gain falls;
else it recovers. A lane change is the driver's; the followed lane changes with the car.
"""

from __future__ import annotations

import math
from functools import partial
from typing import NamedTuple

from costeer.base import array as xp
from costeer.base.array import Flag, Real, compiled
from costeer.base.window import Window, empty_window, full, mean, push
from costeer.controller import actuation, consistency, strength
from costeer.controller.actuation import ActuationParameters, ActuationState
from costeer.controller.consistency import WINDOW_LENGTH
from costeer.controller.guidance import GuidanceParameters
from costeer.controller.preview import PreviewParameters
from costeer.controller.signals import Assistance, Consistency, Request
from costeer.controller.strength import StrengthParameters, StrengthState
from costeer.methods.ibhs import like_ibhs, shared_tunables
from costeer.methods.interface import Method, Tunable
from costeer.methods.lanes import LaneParameters, keep, lateral_velocity
from costeer.plant.parameters import CarParameters, ColumnParameters, RoadParameters
from costeer.records.columns import Column
from costeer.sensing.measurement import Measurement


class CooperationParameters(NamedTuple):
    """When the driver holds the initiative.

    Attributes:
        initiative_threshold: The driver's pseudo-power is positive and this much above
            the system's [W·m]. Source: ours, twice the 99.9th percentile of agreeing
            runs of pilot drivers, benchmarks/rival_thresholds.py.
    """

    initiative_threshold: Real = 0.35


class CooperativeStatusParameters(NamedTuple):
    """Lane keeping whose gain follows the cooperative status.

    Attributes:
        car: Nominal car [SI units]. Source: plant/parameters.py.
        column: Nominal column [SI units]. Source: plant/parameters.py.
        road: Lanes [SI units]. Source: plant/parameters.py.
        lanes: When the followed lane changes [SI units]. Source: methods/lanes.py.
        preview: Preview time [SI units]. Source: Fig. 4.
        guidance: Gains [SI units]. Source: Eq. (5).
        cooperation: Initiative [SI units]. Source: Nishimura et al. 2015.
        strength: Fade [SI units]. Source: Eqs. (10) and (11).
        actuation: Strength and limits [SI units]. Source: Eq. (6), Table IV.
    """

    car: CarParameters = CarParameters()
    column: ColumnParameters = ColumnParameters()
    road: RoadParameters = RoadParameters()
    lanes: LaneParameters = LaneParameters()
    preview: PreviewParameters = PreviewParameters()
    guidance: GuidanceParameters = GuidanceParameters()
    cooperation: CooperationParameters = CooperationParameters()
    strength: StrengthParameters = StrengthParameters()
    actuation: ActuationParameters = ActuationParameters()


class CooperationState(NamedTuple):
    """What is known of the two who steer.

    Attributes:
        guidance_power: Last products of guidance torque and lateral velocity [W·m].
        driver_power: Last products of driver torque and lateral velocity [W·m].
        driver_led: 1 while the driver holds the initiative, else 0 [-].
        cooperates: Whether the gain recovers.
    """

    guidance_power: Window
    driver_power: Window
    driver_led: Real
    cooperates: Flag


class CooperativeStatusState(NamedTuple):
    """What the method remembers.

    Attributes:
        lane: That is followed [-].
        cooperation: Status.
        strength: Fade.
        actuation: Last torque.
    """

    lane: Real
    cooperation: CooperationState
    strength: StrengthState
    actuation: ActuationState


@compiled
def initial_state(
    parameters: CooperativeStatusParameters, lane: Real
) -> CooperativeStatusState:
    """Follow the lane that the car starts in at full gain; nobody leads."""
    return CooperativeStatusState(
        lane=lane,
        cooperation=CooperationState(
            guidance_power=empty_window(WINDOW_LENGTH),
            driver_power=empty_window(WINDOW_LENGTH),
            driver_led=0.0,
            cooperates=True,
        ),
        strength=strength.initial_state(),
        actuation=actuation.initial_state(),
    )


@compiled
def is_driver_led(
    parameters: CooperationParameters, guidance_power: Real, driver_power: Real
) -> Flag:
    """Whether the driver moves the car, and more than the system does.

    Args:
        parameters: How much more.
        guidance_power: Mean of guidance torque times lateral velocity [W·m].
        driver_power: Mean of driver torque times lateral velocity [W·m].
    """
    gap = driver_power - guidance_power
    return (driver_power > 0.0) & (gap > parameters.initiative_threshold)


@compiled
def status(
    parameters: CooperationParameters,
    state: CooperationState,
    measurement: Measurement,
    instructed_torque: Real,
) -> tuple[CooperationState, Consistency]:
    """Who leads, and whether both mean the same.

    Without a finite torque of both there is no new status: the last one stays.

    Args:
        parameters: When the driver leads.
        state: Windows and last status.
        measurement: Driver's torque and lateral velocity.
        instructed_torque: Of the guidance, before gain and strength [N·m].
    """
    velocity, driver = lateral_velocity(measurement), measurement.driver_torque
    guided = push(state.guidance_power, consistency.power(instructed_torque, velocity))
    driven = push(state.driver_power, consistency.power(driver, velocity))
    guidance_power = xp.select(full(guided), mean(guided), math.nan)
    driver_power = xp.select(full(driven), mean(driven), math.nan)
    agreement = consistency.torque_agreement(instructed_torque, driver)
    led = is_driver_led(parameters, guidance_power, driver_power)
    against = led & (agreement < 0.0)
    cooperates = xp.select(
        xp.isfinite(agreement), xp.logical_not(against), state.cooperates
    )
    new_state = CooperationState(
        guidance_power=guided,
        driver_power=driven,
        driver_led=xp.select(led, 1.0, 0.0),
        cooperates=cooperates,
    )
    return new_state, Consistency(
        guidance_pseudo_work=guidance_power,
        driver_pseudo_work=driver_power,
        torque_agreement=agreement,
        consistent=cooperates,
    )


@compiled
def step(
    parameters: CooperativeStatusParameters,
    state: CooperativeStatusState,
    measurement: Measurement,
    request: Request,
    dt: Real,
) -> tuple[CooperativeStatusState, Assistance]:
    """Lane keeping at the gain that the cooperative status calls for.

    Args:
        parameters: Lanes, guidance, initiative, fade, limits.
        state: Lane, status, fade, last torque.
        measurement: This step's sample.
        request: Not looked at.
        dt: Control step [s].
    """
    lane, target, errors, torques = keep(parameters, state.lane, measurement)
    cooperation, verdict = status(
        parameters.cooperation,
        state.cooperation,
        measurement,
        torques.instructed_torque,
    )
    fade, gain = strength.step(
        parameters.strength, state.strength, verdict.consistent, dt
    )
    felt = actuation.felt_instruction(torques, measurement.driver_torque)
    limited, torque = actuation.step(
        parameters.actuation, state.actuation, gain, felt, dt
    )
    new_state = CooperativeStatusState(
        lane=lane, cooperation=cooperation, strength=fade, actuation=limited
    )
    return new_state, Assistance(
        applied_torque=torque,
        haptic_gain=gain,
        target=target,
        preview=errors,
        guidance=torques,
        consistency=verdict,
    )


METHOD = Method(
    name="cooperative-status",
    version="1",
    source="Nishimura, Wada, Sugiyama 2015, arXiv 1504.05770",
    parameters=partial(like_ibhs, CooperativeStatusParameters),
    initial_state=initial_state,
    step=step,
    columns=(
        Column(
            "method_driver_led",
            "-",
            "float64",
            "1 while the driver holds the initiative, else 0",
            "method.cooperation.driver_led",
            stepped=True,
        ),
    ),
    tunables=(
        Tunable(
            "initiative_threshold",
            "cooperation.initiative_threshold",
            "W·m",
            0.0,
            5.0,
            "lead of the driver's pseudo-power",
        ),
        *shared_tunables(CooperativeStatusParameters),
    ),
)
