"""Manual trials of known drivers, simulated once: of population 2, which is fitted."""

from __future__ import annotations

from functools import cache

import numpy as np

from costeer.drivers.driver import DriverParameters
from costeer.identification.likelihood import Evidence
from costeer.identification.model import wheel_motion
from costeer.identification.recording import drive_of
from costeer.identification.stretches import changes, lane_keeping
from costeer.loop.noise import driver_noise
from costeer.loop.rollout import rollout
from costeer.loop.scenario import (
    INTENTIONS,
    TrialSetup,
    loop_parameters,
    trial_driver,
)
from costeer.loop.tick import Script
from costeer.loop.trial import idle_network, simulate_trial
from costeer.methods.manual import MANUAL
from costeer.records.columns import TrialRecord
from costeer.records.row import record_columns

FRESH_SEED = 53
"""Nothing was ever chosen on drivers of this seed."""


def manual_setup(participant: int, length: float = 8000.0) -> TrialSetup:
    return TrialSetup(
        participant=participant,
        seed=FRESH_SEED,
        driver="virtual-2",
        condition="manual",
        method="manual",
        intention="off",
        length=length,
    )


@cache
def recorded(participant: int, length: float = 8000.0) -> TrialRecord:
    return simulate_trial(manual_setup(participant, length))


@cache
def recorded_with(friction: float) -> TrialRecord:
    """A trial without leaders on a wheel with this dry friction [N·m]."""
    setup = manual_setup(1, 1600.0)._replace(events=False)
    parameters = loop_parameters(setup)
    column = parameters.column._replace(friction=friction)
    rows = rollout(
        MANUAL,
        parameters._replace(column=column),
        Script(INTENTIONS["off"], setup.prediction_horizon, np.zeros(0)),
        idle_network(),
        driver_noise(FRESH_SEED, 1, "manual", 9000),
        "numba",
    )
    return TrialRecord({}, record_columns(rows, assisted=False))


def true_driver(participant: int) -> DriverParameters:
    return trial_driver(manual_setup(participant))


def evidence_of(record: TrialRecord, driver: DriverParameters) -> Evidence:
    drive = drive_of(record)
    rows = lane_keeping(drive, changes(drive))
    return Evidence(drive, wheel_motion(drive, driver.arm), rows)


def with_columns(record: TrialRecord, **columns: object) -> TrialRecord:
    """The recording with other columns; those that are None are left out."""
    changed = {**record.columns, **columns}
    kept = {k: np.asanyarray(v) for k, v in changed.items() if v is not None}
    return TrialRecord(record.metadata, kept)


def cut(record: TrialRecord, rows: slice) -> TrialRecord:
    """Some rows of a recording."""
    columns = {name: values[rows] for name, values in record.columns.items()}
    return TrialRecord(record.metadata, columns)
