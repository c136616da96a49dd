"""Hands and feet of a record, replayed: what was done, whatever the car does now.

The torque of the recorded hands acts on the wheel sample by sample, without arms that
would answer to it. Under the conditions of the record the drive is the recorded one;
under others it tells what the same hands would have done to the car.
"""

from __future__ import annotations

from functools import partial
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.base import array as xp
from costeer.base.array import Real, compiled
from costeer.drivers.arm import ArmCommand, ArmParameters
from costeer.drivers.interface import (
    Action,
    Draw,
    DriverModel,
    DriverNoise,
    Knowledge,
    Perception,
)
from costeer.drivers.longitudinal import Pedals
from costeer.records.columns import TrialRecord

Signal = NDArray[np.float64]

NO_ARMS = ArmParameters(
    holding_gain=0.0, stiffness=0.0, intrinsic_share=0.0, inertia=0.0, damping=0.0
)
"""Hands that pass on a torque and nothing else."""

_BLOCK = 4096
"""Samples by which a recording is filled up: lengths share their machine code."""


class Replayed(NamedTuple):
    """What hands and feet did, one sample a control step.

    Attributes:
        torque: Of the hands in the step that begins with the sample, `(time,)` [N·m].
            Source: the record.
        accelerator: Pedal position, `(time,)` [-]. Source: the record.
        brake: Pedal position, `(time,)` [-]. Source: the record.
        head_yaw: Left positive, `(time,)` [-]. Source: the record.
        arm: That passes the torque on [SI units]. Source: this file.
    """

    torque: Signal
    accelerator: Signal
    brake: Signal
    head_yaw: Signal
    arm: ArmParameters = NO_ARMS


class ReplayState(NamedTuple):
    """Samples that have been replayed [-]."""

    samples: int


@compiled
def initial_state(parameters: Replayed, lane_centre: Real) -> ReplayState:
    """At the first sample."""
    return ReplayState(samples=0)


@compiled
def act(
    parameters: Replayed,
    state: ReplayState,
    knowledge: Knowledge,
    perception: Perception,
    noise: DriverNoise,
    dt: Real,
) -> tuple[ReplayState, Action]:
    """Do what was done; after the last sample the hands rest."""
    last = len(parameters.torque) - 1
    k = xp.select(state.samples < last, state.samples, last)
    return ReplayState(samples=state.samples + 1), Action(
        arm=ArmCommand(torque=parameters.torque[k]),
        pedals=Pedals(accelerator=parameters.accelerator[k], brake=parameters.brake[k]),
        head_yaw=parameters.head_yaw[k],
    )


def replayed_hands(record: TrialRecord) -> DriverModel[Replayed, ReplayState]:
    """A driver who does again what a record's driver did.

    The record's torque is the mean over the step before its sample, so that it is
    replayed from the second sample on.

    Args:
        record: With `driver_torque`; pedals and head count as 0 where it has none.

    Raises:
        ValueError: If it has no torque of the driver, or gaps in it.

    Example:
        >>> import costeer
        >>> quick = {"length": 100, "intention": "off", "engine": "python"}
        >>> hands = costeer.replayed_hands(costeer.simulate("manual", **quick))
        >>> again = costeer.simulate("weak-gentle", driver=hands, **quick)
        >>> again.metadata["driver"]
        'replayed-hands 1'
    """
    torque = _signal(record, "driver_torque")
    if torque is None or len(torque) < 2 or not np.isfinite(torque).all():
        raise ValueError(
            "the hands of a record without driver_torque, or with gaps in it, cannot "
            "be replayed; give a record that has it throughout"
        )
    length = -(-len(torque) // _BLOCK) * _BLOCK
    others: dict[str, Any] = {}  # Any: arrays, which name fields
    for name in ("accelerator", "brake", "head_yaw"):
        found = _signal(record, name)
        given = np.zeros(1) if found is None else np.nan_to_num(found)
        others[name] = _filled(given, length, float(given[-1]))
    replayed = Replayed(torque=_filled(torque[1:], length, 0.0), **others)
    return DriverModel(
        name="replayed-hands",
        version="1",
        source="costeer, drivers/replayed.py",
        parameters=partial(_given, replayed),
        initial_state=initial_state,
        act=act,
    )


def _given(replayed: Replayed, draw: Draw) -> Replayed:
    """The same hands for every participant."""
    return replayed


def _signal(record: TrialRecord, name: str) -> Signal | None:
    """A column as floats; None if the record has it not."""
    found = record.columns.get(name)
    return None if found is None else np.asarray(found, dtype=np.float64)


def _filled(signal: Signal, length: int, rest: float) -> Signal:
    """The signal, filled up to a length [samples]."""
    whole = np.full(length, rest)
    whole[: len(signal)] = signal
    return whole
