"""What is done with the real SDL2 in a process of its own; see test_sdl.py."""

from __future__ import annotations

import itertools
import math
import re
import signal
import time
from pathlib import Path
from types import SimpleNamespace
from unittest.mock import patch

from costeer.devices.wheels import sdl
from costeer.devices.wheels.interface import Wheel, WheelLost
from costeer.devices.wheels.registry import emergency_stop, found_wheels, open_wheel
from costeer.devices.wheels.sdl import SdlWheel, sdl_wheels
from costeer.devices.wheels.sdl_session import constant_force, sdl_library
from tests.devices.wheels import fake_wheel as fake


def the_wheel() -> SdlWheel:
    """The only wheel there is, opened."""
    (description,) = sdl_wheels()
    return SdlWheel(description, fake.CALIBRATION)


def finds() -> object:
    """What is found by SDL2, and by all backends together."""
    return [list(wheel) for wheel in (*sdl_wheels(), *found_wheels())]


def pushes() -> object:
    """Torques of every kind, then the end, twice."""
    wheel = the_wheel()
    for torque in (1.0, -1.0, 2.0, -5.0, math.nan, math.inf, 0.5):
        wheel.write(torque)
    wheel.close()
    wheel.close()
    sdl = sdl_library()
    direction = constant_force(sdl).constant.direction.type
    steers = direction == sdl.SDL_HAPTIC_STEERING_AXIS
    return isinstance(wheel, Wheel), wheel.torque_limit, steers


def refreshes() -> object:
    """Torques for 450 ms of a made-up clock; whether something catches SIGTERM then."""
    milliseconds = itertools.count()
    clock = SimpleNamespace(perf_counter=lambda: next(milliseconds) / 1000.0)
    with patch.object(sdl, "time", clock):
        wheel = the_wheel()
        for _ in range(450):
            wheel.write(0.5)
    # Handlers that C code has set; Python itself would not know of them.
    status = Path("/proc/self/status").read_text()
    caught = int(re.findall(r"SigCgt:\s*(\w+)", status)[0], 16)
    wheel.close()
    return bool(caught >> (signal.SIGTERM - 1) & 1)


def moves() -> object:
    """The rim is turned, pedals and paddles are pressed."""
    wheel = the_wheel()
    read = [wheel.read()]
    for value in (0, 16384, 65535, 32768):
        fake.moved(fake.AXIS, fake.STEERING, value)
        read.append(wheel.read())
    fake.moved(fake.AXIS, fake.ACCELERATOR, 0)
    fake.moved(fake.AXIS, fake.BRAKE, 127)
    for button in (4, 5):
        fake.moved(fake.KEY, fake.FIRST_BUTTON + button, 1)
        read.append(wheel.read())
    axes = wheel.axes()
    wheel.close()
    return [list(reading[1:]) for reading in read], axes, read[-1].time


def wakes() -> object:
    """The rim is turned a little, then enough, then back: awake, angle, each time."""
    wheel = the_wheel()
    told = [(wheel.is_awake, wheel.read().steering_wheel_angle, wheel.is_awake)]
    for offset in (100, 400, -400, 420, 0):
        fake.moved(fake.AXIS, fake.STEERING, 32768 + offset)
        told.append((wheel.is_awake, wheel.read().steering_wheel_angle, wheel.is_awake))
    wheel.close()
    fake.stands_at(40000)
    again = the_wheel()
    fake.stands_at(32768)
    told.append((again.is_awake, again.read().steering_wheel_angle, again.is_awake))
    again.close()
    return told


def opens_another() -> object:
    """A wheel is asked for that is not there."""
    (description,) = sdl_wheels()
    try:
        open_wheel(description._replace(address="00#0"), fake.CALIBRATION)
    except WheelLost as error:
        return str(error)
    return None


def stops() -> object:
    """The torque is taken off; one wheel is there, one is not."""
    (description,) = sdl_wheels()
    emergency_stop(description)
    emergency_stop(description._replace(address="00#0"))
    return None


def hurries() -> object:
    """Of a reading and a torque: median of the work [s]."""
    wheel = the_wheel()
    worked = []
    for step in range(2000):
        used = time.thread_time()
        wheel.read()
        wheel.write(math.sin(step))
        worked.append(time.thread_time() - used)
    wheel.close()
    return sorted(worked)[1000]


def loses() -> object:
    """The device is unplugged for good."""
    wheel = the_wheel()
    wheel.write(1.0)
    fake.unplugged()
    reasons = []
    for use in (lambda: wheel.write(1.0), wheel.read, wheel.read, wheel.close):
        try:
            use()
        except WheelLost as error:
            reasons.append(str(error))
    for closed in (wheel.read, lambda: wheel.write(0.0)):
        try:
            closed()
        except WheelLost as error:
            reasons.append(str(error))
    return reasons
