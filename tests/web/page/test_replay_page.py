"""The page replays a record; and its modules keep the rules of view and time."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import pytest

from tests.web.page.conftest import until
from tests.web.page.stub import SPEED, Stub, served

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

pytestmark = pytest.mark.browser


@pytest.fixture(scope="module")
def page(browser: Browser) -> Iterator[Page]:
    stub = Stub()
    stub.mode = "replay"
    with served(stub) as address:
        found = browser.new_page(viewport={"width": 480, "height": 360})
        found.goto(f"{address}/?low&clean")
        until(found, "window.costeer && costeer.lastFrame")
        yield found
        found.close()


def run(page: Page, module: str, body: str) -> Any:  # Any: what the script gives
    """Run a script on a module `m` of the page."""
    return page.evaluate(f"import('/js/{module}').then((m) => {{ {body} }})")


def test_the_whole_record_is_there(page: Page) -> None:
    assert page.evaluate("costeer.frames") == 601
    assert page.title() == "a drive straight on – costeer replay"
    assert page.locator("#transport .marks span").count() == 1
    assert page.locator("#signals canvas").count() == 3


def test_a_click_on_the_signals_seeks(page: Page) -> None:
    area = page.locator("#signals .u-over").first.bounding_box()
    assert area is not None
    page.mouse.click(area["x"] + area["width"] / 2, area["y"] + area["height"] / 2)
    # A pixel is a tenth of a second here; the middle of ten seconds is five.
    assert abs(until(page, "costeer.time") - 5.0) < 0.2


def test_arrows_step_by_one_row(page: Page) -> None:
    page.keyboard.press("Home")
    until(page, "costeer.time === 0 && costeer.lastFrame.time === 0")
    for _ in range(3):
        page.keyboard.press("ArrowRight")
    page.keyboard.press("ArrowLeft")
    until(page, "costeer.lastFrame.time > 0")
    assert page.evaluate("costeer.time") == pytest.approx(2.0 / 60.0)


def test_it_plays_between_rows_and_stops_at_the_end(page: Page) -> None:
    page.keyboard.press("Home")
    page.keyboard.press("ArrowUp")
    page.keyboard.press("ArrowUp")
    page.keyboard.press("Space")
    assert until(page, "costeer.state === 'playing' && costeer.speed") == 4
    frame = until(page, "costeer.time > 1 && costeer.lastFrame")
    driven = frame["longitudinal_position"] - 1000.0
    assert driven == pytest.approx(SPEED * frame["time"], rel=1e-9)
    page.keyboard.press("End")
    until(page, "costeer.state === 'stopped' && costeer.time === 10")


def test_nothing_is_shown_as_a_gain_where_nothing_guides(page: Page) -> None:
    shown = run(
        page,
        "frames.js",
        "const names = ['haptic_gain', 'strength_factor'];"
        "const columns = new m.Columns(names, []);"
        "return [0, 0.4].map((s) => columns.shown([0.8, s], 'haptic_gain'));",
    )
    assert math.isnan(shown[0])
    assert shown[1] == 0.8


BUFFER = """
  const names = ['time', 'sent_time', 'lane'];
  return import('/js/frames.js').then(({Columns}) => {
    const buffer = new m.StateBuffer(new Columns(names, names.slice(1)), 60);
    for (let n = 0; n < 6; n++) {
      buffer.push(Float64Array.of(n / 60, 100 + n / 60, n), 500 + n / 60);
    }
    return TIMES.map((time) => [...buffer.at(time)]);
  });
"""


def test_states_are_shown_late_and_never_far_ahead(page: Page) -> None:
    times = [500.0 + 4.0 / 60.0, 500.0 + 5.0 / 60.0, 501.0]
    first, second, late = run(
        page, "interpolation.js", BUFFER.replace("TIMES", str(times))
    )
    # A frame and a quarter late: between two frames that are there.
    assert first[0] == pytest.approx((4.0 - 1.25) / 60.0)
    assert second[0] == pytest.approx((5.0 - 1.25) / 60.0)
    assert first[2] == 3.0  # a lane is never between two lanes
    assert late[0] == pytest.approx(5.0 / 60.0 + 0.05)


def test_screens_that_face_the_eye_meet_at_their_edges(page: Page) -> None:
    planes = run(page, "scene/eye.js", "return m.screenPlanes(3, 141, null);")
    for plane, yaw in zip(planes, (47.0, 0.0, -47.0), strict=True):
        assert math.degrees(plane["yaw"]) == pytest.approx(yaw)
        half = math.degrees(math.atan(plane["right"]))
        assert half == pytest.approx(47.0 / 2.0)


@pytest.mark.parametrize("angle", [0.0, 30.0, 70.0])
def test_turned_screens_share_their_edge(page: Page, angle: float) -> None:
    left, middle, right = run(
        page, "scene/eye.js", f"return m.screenPlanes(3, 120, {angle});"
    )
    edge = math.atan(middle["right"])
    assert left["yaw"] - math.atan(left["right"]) == pytest.approx(edge)
    assert right["yaw"] - math.atan(right["left"]) == pytest.approx(-edge)
    # The screens are equally wide: seen at distance 1 the nearer looks wider.
    distance = middle["unit"] / left["unit"]
    turned = math.radians(angle)
    half = middle["unit"] / 2.0
    assert distance == pytest.approx(math.cos(turned) + half * math.sin(turned))


AXES = """
  return import('/vendor/three.module.js').then((three) => {
    const road = m.roadAxes();
    const camera = new three.PerspectiveCamera(60, 1, 0.1, 100);
    road.add(camera);
    m.aim(camera, YAW);
    road.updateMatrixWorld(true);
    camera.updateMatrixWorld(true);
    const point = road.localToWorld(new three.Vector3(10, 2, 1));
    return point.project(camera).toArray();
  });
"""


def test_what_is_left_and_above_is_drawn_left_and_above(page: Page) -> None:
    x, y, _ = run(page, "scene/axes.js", AXES.replace("YAW", "0"))
    scale = math.tan(math.radians(30.0))
    assert x == pytest.approx(-0.2 / scale)
    assert y == pytest.approx(0.1 / scale)


def test_a_turn_to_the_left_moves_the_world_to_the_right(page: Page) -> None:
    x, _, _ = run(page, "scene/axes.js", AXES.replace("YAW", "Math.atan(0.2)"))
    assert x == pytest.approx(0.0, abs=1e-6)  # the point lies straight ahead now


MIRROR = """
  const needed = ['js/scene/workshop.js', 'vendor/three.module.js', 'js/scene/axes.js'];
  return Promise.all(needed.map((name) => import('/' + name))).then((modules) => {
    const [{Workshop}, {Vector3}, {roadAxes}] = modules;
    const mirrors = new m.Mirrors(new Workshop(true, 1), 1, 1);
    const axes = roadAxes();
    axes.add(mirrors.cameras, mirrors.group);
    mirrors.fit([{yaw: 0, left: -1, right: 1, unit: 2}], 1.8);
    axes.updateMatrixWorld(true);
    const {camera, mesh} = mirrors.all[0];
    const u = axes.localToWorld(new Vector3(-50, 3, 1)).project(camera).x / 2 + 0.5;
    const glass = mesh.children[mesh.children.length - 1];
    const {position, uv} = glass.geometry.attributes;
    // Place on the glass, from its middle to the driver's right, that shows this u.
    const slope = (position.getX(1) - position.getX(0)) / (uv.getX(1) - uv.getX(0));
    const x = position.getX(0) + (u - uv.getX(0)) * slope;
    const shown = axes.worldToLocal(mesh.localToWorld(new Vector3(x, 0, 0)));
    return shown.y - mesh.position.y;
  });
"""


def test_what_is_behind_on_the_left_is_on_the_left_of_the_mirror(page: Page) -> None:
    assert run(page, "scene/mirrors.js", MIRROR) > 0.01
