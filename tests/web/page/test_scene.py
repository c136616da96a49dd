"""The scene puts road and cars where they are; sounds follow what happens."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

from tests.web.page.stub import Stub, served

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

pytestmark = pytest.mark.browser

SCENE = "/js/scene/"


@pytest.fixture(scope="module")
def page(browser: Browser) -> Iterator[Page]:
    """A page that serves the modules and draws nothing."""
    with served(Stub()) as address:
        page = browser.new_page()
        page.goto(f"{address}/missing.html")
        yield page
        page.close()


def places(page: Page, stations: list[list[float]], along: list[float]) -> Any:
    """Where a road with these stations is, `[x, y, heading]` each."""
    return page.evaluate(
        """async ([stations, along]) => {
          const { Alignment } = await import("/js/scene/alignment.js");
          const road = new Alignment(stations);
          return along.map((s) => {
            const { x, y, heading } = road.place(s);
            return [x, y, heading];
          });
        }""",
        [stations, along],
    )


def test_arc_of_the_road_is_a_circle(page: Page) -> None:
    radius = 500.0
    along = [0.0, 7.0, 250.0, 1234.5]
    found = np.array(places(page, [[0, 1 / radius]], along))
    angle = np.array(along) / radius
    wanted = [radius * np.sin(angle), radius * (1.0 - np.cos(angle)), angle]
    np.testing.assert_allclose(found.T, wanted, atol=1e-6)


def test_clothoid_of_the_road_is_the_spiral_of_fresnels_integrals(page: Page) -> None:
    special = pytest.importorskip("scipy.special")
    length, radius = 200.0, 300.0
    scale = math.sqrt(math.pi * radius * length)
    along = [30.0, 101.0, 200.0]
    found = np.array(places(page, [[0, 0], [length, -1 / radius]], along))
    sine, cosine = special.fresnel(np.array(along) / scale)
    heading = -np.square(along) / (2.0 * radius * length)
    np.testing.assert_allclose(
        found.T, [scale * cosine, -scale * sine, heading], atol=1e-6
    )


def test_road_is_straight_before_its_first_station_and_goes_on_after_the_last(
    page: Page,
) -> None:
    found = places(page, [[0, 0], [100, 0.002]], [-50.0, 100.0, 100.0 + 500 * math.pi])
    assert found[0] == [-50.0, 0.0, 0.0]
    # Half a circle of 500 m later the road runs the other way, 1 km to the side.
    before, after = np.array(found[1]), np.array(found[2])
    assert after[2] - before[2] == pytest.approx(math.pi)
    across = np.array([-math.sin(before[2]), math.cos(before[2])])
    np.testing.assert_allclose(after[:2] - before[:2], 1000 * across, atol=1e-5)


def test_cars_ahead_in_a_curve_stand_on_the_road(page: Page) -> None:
    place = page.evaluate(
        """async () => {
          const { Alignment } = await import("/js/scene/alignment.js");
          const { Course } = await import("/js/scene/course.js");
          const course = new Course(new Alignment([[0, 0.002]]));
          course.moveTo(321.0);
          return course.at(100.0, -3.5);
        }"""
    )
    # From anywhere on a circle it looks the same: 0.2 rad on, 3.5 m further out.
    wanted = (503.5 * math.sin(0.2), 500.0 - 503.5 * math.cos(0.2), 0.2)
    assert (place["x"], place["y"], place["heading"]) == pytest.approx(wanted, abs=0.01)


MARKS = """async (role) => {
  const { Alignment } = await import("/js/scene/alignment.js");
  const { Course } = await import("/js/scene/course.js");
  const { layoutOf } = await import("/js/scene/layout.js");
  const { buildMarks } = await import("/js/scene/marks.js");
  const { Workshop } = await import("/js/scene/workshop.js");
  const layout = layoutOf({ lane_width: 3.5, num_lanes: 2, overtaking_side: -1 });
  const scenario = {
    events: [["gust", 500, 560, "left"], ["gust", 2000, 2060, "right"],
      ["lane-change", 700, 800, "right"]],
    zones: [["bend", 400, 900]],
  };
  const course = new Course(new Alignment());
  const marks = buildMarks(new Workshop(true, 1), course, layout, { role, scenario });
  course.moveTo(300);
  marks.update(300);
  return marks.group.children.map((mesh) => {
    mesh.geometry.computeBoundingBox();
    const { min, max } = mesh.geometry.boundingBox;
    return [mesh.visible, mesh.position.x, mesh.position.y, min.y, max.y, max.z];
  });
}"""


def test_windsocks_stand_where_gusts_begin_and_show_their_side(page: Page) -> None:
    left, right = page.evaluate(MARKS, "driver")
    # Under left-hand traffic beyond the barrier on the left, 2.5 m from the lane.
    assert left[:2] == [True, 200]
    assert left[2] > 1.75 + 2.5
    assert left[4] > 2.0 > -0.5 < left[3]
    assert right[0] is False
    assert right[3] < -2.0 < 0.5 > right[4]
    assert left[5] > 4.0


def test_lines_of_zones_are_for_experimenters(page: Page) -> None:
    assert len(page.evaluate(MARKS, "driver")) == 2
    lines = page.evaluate(MARKS, "experimenter")[2:]
    assert [line[:2] for line in lines] == [[True, 100], [True, 600]]
    for _, _, _, right, left, height in lines:
        # Across both lanes and what is paved beside them.
        assert (right, left) == (pytest.approx(-7.75), pytest.approx(4.25))
        assert 0.0 < height < 0.1


def test_brake_lamps_and_indicators_tell_what_a_car_does(page: Page) -> None:
    told = page.evaluate(
        """async () => {
          const { Vehicle } = await import("/js/scene/vehicle.js");
          const { Workshop } = await import("/js/scene/workshop.js");
          const { Course } = await import("/js/scene/course.js");
          const { Alignment } = await import("/js/scene/alignment.js");
          const course = new Course(new Alignment());
          const car = new Vehicle(new Workshop(true, 1), ["truck", 12, 2.5], 1);
          const told = [];
          for (let n = 0; n <= 30; n++) {
            const [time, turns] = [0.2 * n, Math.max(0, n - 15)];
            car.update(course, {
              ahead: 30, lateral: -3.5 + 0.2 * Math.min(turns, 10),
              velocity: 20 - 0.4 * Math.min(n, 10), time,
            });
            told.push([car.isBraking, car.side]);
          }
          return told;
        }"""
    )
    assert told[5] == [True, 0]  # 2 m/s²
    assert told[14] == [False, 0]
    assert told[20] == [False, 1]  # 1 m/s to the left
    assert told[30] == [False, 0]


FAKE = """
class Parameter {
  constructor() { this.value = 0; }
  setTargetAtTime(value) { this.value = value; }
  setValueAtTime(value) { this.value = value; }
  exponentialRampToValueAtTime(value) {}
}
class Node {
  constructor(kind) {
    this.kind = kind;
    [this.frequency, this.gain] = [new Parameter(), new Parameter()];
  }
  connect() {}
  start() { Fake.started.push(this); }
  stop() {}
}
class Fake {
  static started = [];
  sampleRate = 8000; currentTime = 0; destination = {};
  createGain() { return new Node("gain"); }
  createOscillator() { return new Node("oscillator"); }
  createBiquadFilter() { return new Node("filter"); }
  createBufferSource() { return new Node("noise"); }
  createBuffer() { return { getChannelData: () => new Float32Array(16) }; }
  async resume() {}
}
"""


def heard(page: Page, script: str, lacks: str = "false") -> Any:
    """What a script returns that has a woken `sound` on a fake device."""
    return page.evaluate(
        f"""async () => {{
          {FAKE}
          localStorage.clear();
          const {{ Sound }} = await import("/js/sound.js");
          const make = () => new Fake();
          const sound = new Sound({{ make, lacks: async () => {lacks} }});
          const still = {{ speed: 0, accelerator: 0, contact: 0, indicator: 0,
            isRunning: true, warns: false, time: 0 }};
          const level = (name) => sound.graph.level(name).gain.value;
          sound.update(still);
          const silentBefore = sound.graph === null;
          await sound.wake();
          {script}
        }}"""
    )


def test_nothing_sounds_before_a_gesture_or_without_a_device(page: Page) -> None:
    assert heard(page, "return silentBefore") is True
    assert heard(page, "sound.update(still); return sound.graph", "true") is None


def test_wind_and_tyres_grow_with_speed_and_the_strip_hums_at_its_grooves(
    page: Page,
) -> None:
    slow, fast, strip, paused = heard(
        page,
        """const levels = () => ["engine", "tyres", "wind", "rumble"].map(level);
        const out = [];
        for (const state of [{ speed: 10 }, { speed: 30 }, { speed: 30, contact: 1 },
          { speed: 30, isRunning: false }]) {
          sound.update({ ...still, ...state });
          out.push([...levels(), sound.graph.strip.frequency.value]);
        }
        return out;""",
    )
    assert slow[1] < fast[1]
    assert slow[2] < 0.3 * fast[2]
    assert (slow[3], fast[3]) == (0.0, 0.0)
    assert strip[3] > 0.3
    assert strip[4] == pytest.approx(50.0)  # 30 m/s over 0.6 m
    assert paused[:4] == [0.0, 0.0, 0.0, 0.0]


def test_indicator_ticks_a_hit_thumps_and_mute_is_kept(page: Page) -> None:
    ticks, thumps, master, kept = heard(
        page,
        """const count = () => Fake.started.length;
        let before = count();
        for (let n = 0; n < 60; n++) {
          sound.update({ ...still, indicator: 1, time: n / 30 });
        }
        const ticks = count() - before;
        sound.update({ ...still, time: 3 });
        before = count();
        for (let n = 0; n < 5; n++) sound.update({ ...still, contact: 3 });
        const thumps = count() - before;
        sound.change(1);
        sound.toggle();
        const [again, master] = [new Sound({ make }), sound.graph.master];
        return [ticks, thumps, master.gain.value, [again.isMuted, again.volume]];""",
    )
    assert ticks == 6  # on and off, 1.5 times a second, in 2 s
    assert thumps == 2
    assert master == 0.0
    assert kept == [True, 0.7]


def test_slow_machine_draws_mirrors_less_often_and_recovers(page: Page) -> None:
    found = page.evaluate(
        """async () => {
          const { Pace } = await import("/js/scene/pace.js");
          const pace = new Pace();
          let time = 0;
          const after = (count, step) => {
            let level;
            for (let n = 0; n < count; n++) level = pace.tick((time += step));
            return [level.mirrorsEvery, level.isSmooth];
          };
          return [after(19, 0.2), after(100, 0.2), after(2000, 0.02)];
        }"""
    )
    assert found == [[2, True], [4, False], [1, True]]
