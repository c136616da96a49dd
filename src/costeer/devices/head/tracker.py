"""Follow a face from picture to picture: found, followed, lost, found again."""

from __future__ import annotations

import math
from typing import NamedTuple

from costeer.devices.head.face import (
    FaceNetworks,
    FaceParameters,
    Image,
    Region,
    detect,
    measure_face,
    region_of,
)
from costeer.devices.head.pose import head_pose


class TrackerParameters(NamedTuple):
    """What is believed of a face.

    Attributes:
        face: When a face counts as found.
        largest_yaw: Beyond it half the face is hidden and the angle is a guess [rad].
            Source: measured on rendered faces, whose yaw is underrated from 50 deg.
        largest_jump: Change from one picture to the next that is believed [rad].
            Source: assumed, 15 deg; heads turn 5 to 10 deg in a thirtieth of a second.
        fastest_turn: The same for pictures that are further apart [rad/s]. Source:
            assumed, 15 deg in a thirtieth of a second.
    """

    face: FaceParameters = FaceParameters()
    largest_yaw: float = math.radians(50.0)
    largest_jump: float = math.radians(15.0)
    fastest_turn: float = math.radians(450.0)


class TrackerState(NamedTuple):
    """What is known of the head.

    Attributes:
        region: Where the face is looked for; None if it must be found first.
        head_yaw: Last angle that was believed, positive to the left [rad].
        valid: Whether the last picture gave it.
        time_since: Time since it was believed; infinite if none ever was [s].
    """

    region: Region | None
    head_yaw: float
    valid: bool
    time_since: float


class Sight(NamedTuple):
    """What one picture shows.

    Attributes:
        region: Of the face; None if there is none.
        head_yaw: Its yaw, positive to the left; NaN if there is none [rad].
    """

    region: Region | None
    head_yaw: float


NO_FACE = Sight(region=None, head_yaw=math.nan)
"""A picture without a face."""


def initial_state() -> TrackerState:
    """Nothing seen yet."""
    return TrackerState(region=None, head_yaw=0.0, valid=False, time_since=math.inf)


def step(
    parameters: TrackerParameters,
    networks: FaceNetworks,
    state: TrackerState,
    image: Image,
    dt: float,
) -> TrackerState:
    """Look at one picture.

    Args:
        parameters: What is believed.
        networks: Detector and landmarks.
        state: What was known before.
        image: Picture of a camera that faces the driver, not mirrored.
        dt: Time since the picture before [s].
    """
    sight = look(parameters.face, networks, state.region, image)
    return judge(parameters, state, sight, dt)


def look(
    parameters: FaceParameters,
    networks: FaceNetworks,
    region: Region | None,
    image: Image,
) -> Sight:
    """Find the face: near where it was, else anywhere in the picture."""
    if region is not None:
        sight = _look_at(parameters, networks, region, image)
        if sight.region is not None:
            return sight
    found = detect(parameters, networks, image)
    if found is None:
        return NO_FACE
    rough = _look_at(parameters, networks, found, image)
    if rough.region is None:
        return NO_FACE
    # The detector's region is rough, and the angle depends on it a little.
    return _look_at(parameters, networks, rough.region, image)


def _look_at(
    parameters: FaceParameters, networks: FaceNetworks, region: Region, image: Image
) -> Sight:
    """The face in a region."""
    face = measure_face(networks, image, region)
    if face.presence < parameters.least_presence:
        return NO_FACE
    height, width = image.shape[:2]
    pose = head_pose(face.landmarks, width, height)
    if pose is None:
        return NO_FACE
    return Sight(region_of(parameters, face.landmarks), pose.yaw)


def judge(
    parameters: TrackerParameters, state: TrackerState, sight: Sight, dt: float
) -> TrackerState:
    """Believe an angle or keep the last one; a face that leaps is looked for anew."""
    time_since = state.time_since + dt
    leap = abs(sight.head_yaw - state.head_yaw)
    reach = max(parameters.largest_jump, parameters.fastest_turn * time_since)
    near = leap <= reach  # false if there is no face: NaN
    if near and abs(sight.head_yaw) <= parameters.largest_yaw:
        return TrackerState(sight.region, sight.head_yaw, True, 0.0)
    return TrackerState(
        region=sight.region if near else None,
        head_yaw=state.head_yaw,
        valid=False,
        time_since=time_since,
    )
