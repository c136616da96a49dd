"""All that one virtual driver is and remembers, part by part."""

from __future__ import annotations

from typing import NamedTuple

from costeer.base.array import Real, compiled
from costeer.drivers import (
    correcting,
    decision,
    evasion,
    gaze,
    indicating,
    learning,
    longitudinal,
    reliance,
    tolerance,
    tracking,
    vision,
)
from costeer.drivers.arm import ArmParameters
from costeer.drivers.correcting import CorrectingParameters, CorrectingState
from costeer.drivers.decision import DecisionState
from costeer.drivers.evasion import EvasionParameters, EvasionState
from costeer.drivers.gaze import GazeParameters, GazeState
from costeer.drivers.indicating import IndicatorParameters, IndicatorState
from costeer.drivers.learning import LearningParameters, LearningState
from costeer.drivers.longitudinal import LongitudinalParameters, LongitudinalState
from costeer.drivers.overtaking import DecisionParameters
from costeer.drivers.reliance import RelianceParameters, RelianceState
from costeer.drivers.tolerance import ToleranceParameters, ToleranceState
from costeer.drivers.tracking import TrackingParameters, TrackingState
from costeer.drivers.vision import VisionParameters, VisionState


class DriverParameters(NamedTuple):
    """One driver.

    Attributes:
        vision: Eyes to intended angle [SI units]. Source: drivers/vision.py.
        arm: Intended angle to torque [SI units]. Source: drivers/arm.py.
        reliance: Hands that feel [SI units]. Source: drivers/reliance.py.
        tracking: Aim in the lane [SI units]. Source: drivers/tracking.py.
        decision: When to change lanes [SI units]. Source: drivers/decision.py.
        gaze: Glances [SI units]. Source: drivers/gaze.py.
        longitudinal: Speed [SI units]. Source: drivers/longitudinal.py.
        evasion: Emergencies [SI units]. Source: drivers/evasion.py.
        indicator: When it is set [SI units]. Source: drivers/indicating.py.
        correcting: Planning anew [SI units]. Source: drivers/correcting.py.
        learning: Experience with guidance [SI units]. Source: drivers/learning.py.
        tolerance: When it is corrected [SI units]. Source: drivers/tolerance.py.

    Example:
        >>> import costeer
        >>> driver = costeer.Driver()
        >>> stiff = driver._replace(arm=driver.arm._replace(stiffness=20.0))
        >>> record = costeer.simulate("manual", length=200, driver=stiff)
    """

    vision: VisionParameters = VisionParameters()
    arm: ArmParameters = ArmParameters()
    reliance: RelianceParameters = RelianceParameters()
    tracking: TrackingParameters = TrackingParameters()
    decision: DecisionParameters = DecisionParameters()
    gaze: GazeParameters = GazeParameters()
    longitudinal: LongitudinalParameters = LongitudinalParameters()
    evasion: EvasionParameters = EvasionParameters()
    indicator: IndicatorParameters = IndicatorParameters()
    correcting: CorrectingParameters = CorrectingParameters()
    learning: LearningParameters = LearningParameters()
    tolerance: ToleranceParameters = ToleranceParameters()


class DriverState(NamedTuple):
    """What the driver remembers."""

    vision: VisionState
    reliance: RelianceState
    tracking: TrackingState
    decision: DecisionState
    gaze: GazeState
    longitudinal: LongitudinalState
    evasion: EvasionState
    indicator: IndicatorState
    correcting: CorrectingState
    learning: LearningState
    tolerance: ToleranceState


@compiled
def initial_state(parameters: DriverParameters, lateral_position: Real) -> DriverState:
    """A driver in a lane whose centre lies at `lateral_position` [m]."""
    aimed = lateral_position + parameters.tracking.lane_bias
    return DriverState(
        vision=vision.initial_state(),
        reliance=reliance.initial_state(),
        tracking=tracking.initial_state(aimed),
        decision=decision.initial_state(),
        gaze=gaze.initial_state(),
        longitudinal=longitudinal.initial_state(),
        evasion=evasion.initial_state(),
        indicator=indicating.initial_state(),
        correcting=correcting.initial_state(),
        learning=learning.initial_state(parameters.learning),
        tolerance=tolerance.initial_state(),
    )
