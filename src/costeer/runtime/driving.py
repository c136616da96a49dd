"""A drive as the real-time process steps it: commands, safety, control, frames.

Nothing here waits for a clock; `process.py` calls `control_step` 60 times a second
and `plant_step` 960 times. What others must know goes to shared memory, what they ask
for comes through a pipe that is looked at once in a control step.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from contextlib import suppress
from typing import Any

from costeer.devices.wheels.hands import warm_up_hands
from costeer.devices.wheels.interface import EFFECT_LIFE, WheelLost
from costeer.devices.wheels.registry import open_wheel
from costeer.loop.tick import NO_VERDICT
from costeer.plant.road import lane_centre
from costeer.records.row import ROW_COLUMNS
from costeer.runtime.bay import Bay, Opener
from costeer.runtime.cabin import Cabin, Controls
from costeer.runtime.choices import Choices
from costeer.runtime.contacts import Contacts
from costeer.runtime.frame import FrameRow
from costeer.runtime.indicator import Indicator
from costeer.runtime.links import Links
from costeer.runtime.markers import Kind, Marker
from costeer.runtime.patience import (
    PAGE_PATIENCE,
    SERVER_PATIENCE,
    STOP_PATIENCE,
    WHEEL_PATIENCE,
    newest_verdict,
    sees_head,
)
from costeer.runtime.setup import (
    DriveSetup,
    drive_columns,
    drive_parameters,
    leader_draws,
)
from costeer.runtime.shared import Shared, next_rows
from costeer.runtime.states import Fault, RunState
from costeer.runtime.trace import Tracer
from costeer.runtime.watchdog import stands_still
from costeer.scenarios.reading import scenario_named

NEVER = math.inf
_LANE, _POSITION, _LATERAL, _YAW = map(
    ROW_COLUMNS.index,
    ("lane", "longitudinal_position", "lateral_position", "yaw_angle"),
)
_TIME, _ANGLE, _APPEARED, _CONTACT = map(
    ROW_COLUMNS.index, ("time", "steering_wheel_angle", "event", "contact")
)


class Driving:
    """The state of a drive and its two steps.

    Args:
        setup: Of the drive.
        links: To the others.
        shared: Memory of the drive.
        clock: Time that all processes share [s]; a test has its own.
        opener: Opens a wheel; a test has its own.

    Raises:
        ValueError: If the drive cannot begin.
        OSError: If the wheel cannot be opened.
    """

    def __init__(
        self,
        setup: DriveSetup,
        links: Links,
        shared: Shared,
        clock: Callable[[], float] = time.perf_counter,
        opener: Opener = open_wheel,
    ) -> None:
        self._setup = setup
        self._links = links
        self._clock = clock
        self._shared = shared
        self._mailbox, self._frames = shared.mailbox, shared.frames
        self._tracer = Tracer(shared.trace)
        self._cabin = Cabin(setup, self._is_released)
        self._bay = Bay(setup, self._cabin, self._mailbox, clock, opener)
        self._stepped_at = NEVER
        self._road = drive_parameters(setup).road
        self._draws = leader_draws(setup)
        self._frame = FrameRow(drive_columns(setup))
        self._choices = Choices(self._cabin, setup, self._mark)
        self._indicator = Indicator(self._mark)
        after = scenario_named(setup.trial.scenario).after_collision
        self._contacts = Contacts(after, self._mark)
        self.stopping = self.is_told_to_end = False
        self._stop_at = NEVER
        self._run_state, self._fault = RunState.WAITING, Fault.NONE
        self._compute_time = self._applied = 0.0
        self._leaders = 0
        self._last_event = self._paused_at = 0.0
        links.wake.setblocking(False)

    def warm_up(self) -> None:
        """Compile everything before the wheel is opened: some switch off when idle."""
        self._cabin.warm_up()
        warm_up_hands()

    def open_wheel(self) -> None:
        """Open the wheel; the loop must begin at once.

        Raises:
            OSError: If it is not there.
        """
        self._bay.open()

    def close(self) -> None:
        """Take the torque off the wheel and let it go; watched until it is done."""
        self._bay.close()

    @property
    def _time(self) -> float:
        """Of the trial [s]."""
        return float(self._cabin.memory.row[_TIME])

    @property
    def is_running(self) -> bool:
        """Whether the trial runs."""
        return self._run_state == RunState.RUNNING

    # The control step, 60 Hz

    def control_step(self, lateness: float) -> None:
        """Hear, check, run the controller, tell.

        Args:
            lateness: Largest since the last control step [s].
        """
        start = self._clock()
        self._mailbox.put(heartbeat=start)
        self._hear()
        self._indicator.look(self._cabin.reading, self._time)
        self._look_around(start)
        if self._run_state == RunState.RUNNING:
            self._applied = self._mailbox.get("input_sequence")
            self._after(self._cabin.control(self._controls(start)))
        self._compute_time = self._clock() - start
        self._tell(self._cabin.memory.row, lateness)

    def _controls(self, now: float) -> Controls:
        """What person, head and network say at this step."""
        box, asked = self._mailbox, self._setup.intention == "network"
        verdict = newest_verdict(box, self._frames.written) if asked else NO_VERDICT
        lane = float(self._cabin.memory.row[_LANE])
        asks = self._indicator.asks(self._time, self._road, lane)
        requested = asks and self._setup.intention == "indicator"
        return Controls(
            steer=box.get("steer"),
            steering=box.get("steering") > 0.5,
            accelerator=box.get("accelerator"),
            brake=box.get("brake"),
            head_yaw=box.get("head_yaw"),
            head_valid=sees_head(box, now),
            crossing_probability=verdict.probability,
            crossing_side=self._indicator.side if requested else verdict.side,
            requested=requested,
            leader_uniform=float(self._draws[self._leaders % len(self._draws)]),
            indicator=self._indicator.side,
        )

    def _after(self, row: Any) -> None:  # Any: an array of float64
        """Look at what the step gave: leaders, contacts, the course's end, numbers."""
        event = float(row[_APPEARED])
        if event > self._last_event:
            self._leaders = int(event)
        self._last_event = event
        if not math.isfinite(row[_POSITION] + row[_ANGLE]):
            self._break_off(Fault.NOT_FINITE)
            return
        offset = row[_LATERAL] - lane_centre(self._road, row[_LANE])
        self._indicator.follow(row[_LANE], offset, row[_YAW], self._time)
        if self._contacts.look(row[_CONTACT], self._clock()):
            self._run_state = RunState.ENDED
        elif row[_POSITION] >= self._road.length:
            self._run_state = RunState.ENDED
            self._mark(Marker("ended", "course"))

    def _tell(self, row: Any, lateness: float) -> None:  # Any: an array of float64
        """Put a frame into the ring and wake the server."""
        reading = self._cabin.reading
        extra = (
            float(self._run_state),
            float(self._fault),
            self._cabin.wheel_torque,
            self._cabin.fade,
            self._cabin.hands.intended_angle,
            self._applied,
            self._clock() if reading is None else reading.time,
            self._clock(),
            self._compute_time,
            lateness,
            self._cabin.strength,
            self._choices.number,
            self._indicator.side,
        )
        self._frame.fill(row, extra)
        if self._run_state != RunState.RUNNING:
            self._frame.numbers[_ANGLE] = self._cabin.steering_wheel_angle
        self._frames.put(self._frame.numbers)
        with suppress(OSError):
            self._links.wake.send(b"f")

    # The plant step, 960 Hz

    def plant_step(self, late: float) -> None:
        """Wheel and car one plant step on."""
        start = self._clock()
        self._look_back(start)
        moving = self._run_state == RunState.RUNNING
        try:
            self._cabin.advance(moving, self._fault != Fault.NONE)
        except WheelLost:
            self._bay.lose()
            self._break_off(Fault.WHEEL_LOST)
        self._stepped_at = now = self._clock()
        self._mailbox.put(heartbeat=now)
        reading = self._cabin.reading
        if moving and reading is not None and now - reading.time > WHEEL_PATIENCE:
            self._break_off(Fault.SENSOR_STALE)
        if moving:
            self._tracer.put(self._frame.numbers[_TIME], late, now - start, self._cabin)
        else:
            self._tracer.follow(late, now - start, self._cabin)

    # Safety

    def _is_released(self) -> bool:
        """Whether the watchdog has told the wheel to let go."""
        return self._mailbox.get("stalled") > 0.5

    def _look_back(self, now: float) -> None:
        """Break off after having stood still, from the torque that is left: none."""
        if self._is_released():
            self._break_off(Fault.STALLED)
        elif self._cabin.wheel is not None and now - self._stepped_at > EFFECT_LIFE:
            self._cabin.release()
            self._break_off(Fault.STALLED)

    def _look_around(self, now: float) -> None:
        """Stop what must not go on: no server, no page, no fresh reading."""
        if now - self._mailbox.get("server_time") > SERVER_PATIENCE:
            self.stopping = True
        if now > self._stop_at or (self._cabin.fade == 0.0 and self._stop_at < NEVER):
            self.stopping = True
        if self._contacts.begins_anew(now):
            self._do_restart()
        if self._run_state != RunState.RUNNING:
            return
        if self._is_unwatched(now):
            self._break_off(Fault.WATCHDOG_STILL)
        if self._setup.needs_page:
            silence = now - self._mailbox.get("page_time")
            if silence > PAGE_PATIENCE:
                self._break_off(Fault.PAGE_LOST)

    def _pause(self) -> None:
        self._run_state, self._paused_at = RunState.PAUSED, self._clock()

    def _is_unwatched(self, now: float) -> bool:
        """Whether there is a wheel that nobody would stop."""
        return self._setup.wheel is not None and stands_still(self._mailbox, now)

    def _break_off(self, fault: Fault) -> None:
        """Pause for a fault; the torque ends at once, the record is kept."""
        if self._fault == fault or not self._fault.can_resume:
            return
        self._fault = fault
        if self._run_state == RunState.RUNNING:
            self._pause()
        self._mark(Marker("fault", fault.word))

    # Commands

    def _hear(self) -> None:
        """Do what a signal or the server has asked for since the last step."""
        if self.is_told_to_end:
            self._do_stop()
        while self._links.commands.poll():
            try:
                word, *values = self._links.commands.recv()
            except (EOFError, OSError):
                self.stopping = True
                return
            act: Callable[..., None] = getattr(self, f"_do_{word}")
            try:
                act(*values)
            except (ValueError, OSError) as error:
                self._mark(Marker("error", note=str(error)))

    def _mark(self, marker: Marker) -> None:
        """Tell the server what happened, when in the trial, and before which rows."""
        timed = marker._replace(time=self._time)
        self._links.commands.send(("marker", timed, next_rows(self._shared)))

    def _do_stop(self) -> None:
        if self._stop_at < NEVER:
            return  # it was told before
        if self._run_state in (RunState.RUNNING, RunState.PAUSED):
            self._mark(Marker("ended", "server"))
        self._run_state = RunState.ENDED
        self._stop_at = self._clock() + STOP_PATIENCE

    def _do_start(self) -> None:
        if self._run_state == RunState.WAITING:
            self._begin("started")

    def _do_resume(self) -> None:
        if self._run_state == RunState.PAUSED:
            self._begin("resumed")

    def _do_acknowledge(self) -> None:
        """Take a fault as mended, if it is; who drives may go on."""
        if self._fault.must_be_acknowledged or not self._fault.can_resume:
            self._make_ready()
            self._fault = Fault.ACKNOWLEDGED
            self._mark(Marker("fault", Fault.ACKNOWLEDGED.word))

    def _make_ready(self) -> None:
        """Have a wheel that is there and watched, or say what is wrong."""
        self._forget_stall()
        if self._bay.is_empty:
            self._bay.find()
            self._stepped_at = NEVER
        still = self._is_unwatched(self._clock())
        if still or not self._fault.can_resume:
            raise ValueError((Fault.WATCHDOG_STILL if still else self._fault).text)
        self._cabin.check_wheel()

    def _begin(self, kind: Kind) -> None:
        """Run, if wheel and numbers allow it and no fault waits for a word."""
        if self._is_released():
            self._break_off(Fault.STALLED)
        if self._fault.must_be_acknowledged:
            raise ValueError(f"{self._fault.text} Then say that it is mended.")
        self._make_ready()
        self._fault = Fault.NONE
        self._cabin.meet_wheel()
        self._run_state = RunState.RUNNING
        stood = round(self._clock() - self._paused_at, 3)
        marker = Marker(kind, after=stood, unit="s")
        self._mark(Marker(kind) if kind == "started" else marker)

    def _forget_stall(self) -> None:
        """The watchdog has told the wheel to let go: it is to be opened anew, once."""
        if self._fault == Fault.STALLED or self._is_released():
            self._mailbox.put(stalled=0.0)
            self._bay.lose()
            self._stepped_at = NEVER
            self._fault = Fault.WHEEL_LOST

    def _do_leave(self) -> None:
        if self.is_running and self._setup.needs_page:
            self._break_off(Fault.PAGE_LOST)

    def _do_pause(self, why: str) -> None:
        if self._run_state == RunState.RUNNING:
            self._pause()
            self._mark(Marker("paused", why))

    def _do_restart(self) -> None:
        self._forget_stall()
        if self._fault not in (Fault.RECORD_STOPPED, Fault.UNWATCHED):
            self._fault = Fault.NONE  # a lost wheel is looked for at the start
        self._tracer.leave()
        self._cabin.begin()
        self._leaders, self._last_event = 0, 0.0
        self._indicator.forget()
        self._contacts.forget()
        self._run_state = RunState.WAITING
        self._mark(Marker("restarted"))

    def _do_unwatched(self) -> None:
        self._break_off(Fault.UNWATCHED)

    def _do_unrecorded(self, is_so: bool) -> None:
        """Wait while nothing can be recorded; say so once it can."""
        if is_so:
            self._break_off(Fault.RECORD_STOPPED)
        elif self._fault == Fault.RECORD_STOPPED:
            is_paused = self._run_state == RunState.PAUSED
            self._fault = Fault.RECORD_MENDED if is_paused else Fault.NONE

    def _do_indicator(self, side: float) -> None:
        self._indicator.put(float(side), self._time)

    def _do_set(self, name: str, value: float | str) -> None:
        self._choices.set(name, value)
