"""OpenDRIVE roads: curvature against closed forms, lanes, and what is refused."""

from __future__ import annotations

import math
import time
from pathlib import Path

import numpy as np
import pytest
from scipy.special import fresnel

from costeer.scenarios.definition import Bent, Road, Scenario
from costeer.scenarios.opendrive.roads import Imported, read_road
from costeer.scenarios.opendrive.tree import parsed_tree
from costeer.scenarios.opendrive.writing import road_text
from costeer.scenarios.reading import scenario_named, shipped
from costeer.scenarios.world import curvatures
from tests.scenarios.roads import LINE, TWO, lane, road, section, straight, write


def geometry(shape: str, length: float, s: float = 0.0) -> str:
    return f'<geometry s="{s}" x="0" y="0" hdg="0" length="{length}">{shape}</geometry>'


def border(number: int, at: float) -> str:
    """A lane by its outer edge."""
    edge = f'<border sOffset="0" a="{at}" b="0" c="0" d="0"/>'
    return f'<lane id="{number}" type="driving">{edge}</lane>'


def bends(read: Imported, *places: float) -> list[float]:
    return curvatures(read.road.stations, np.array(places)).tolist()


def test_an_arc_has_the_curvature_of_the_left_lane(tmp_path: Path) -> None:
    # Lane -1 is 1.75 m to the right of the reference line, outside a left curve.
    plan = geometry('<arc curvature="0.004"/>', 400)
    read = read_road(write(tmp_path, road(plan)))
    assert read.road.length == pytest.approx(400 * 251.75 / 250, abs=0.01)
    assert bends(read, 50, 350) == pytest.approx([1 / 251.75] * 2, rel=1e-5)
    assert (read.road.lanes, read.road.lane_width) == (2, 3.5)
    assert read.road.traffic == "right"
    assert read.errors.stretch < 0.01


def test_the_other_direction_bends_the_other_way(tmp_path: Path) -> None:
    both = section(left=lane(2) + lane(1), right=lane(-1) + lane(-2))
    file = write(tmp_path, road(geometry('<arc curvature="0.004"/>', 400), both))
    read = read_road(file, against=True)
    assert bends(read, 200) == pytest.approx([-1 / 248.25], rel=1e-5)


def test_left_hand_traffic_drives_on_the_left(tmp_path: Path) -> None:
    # Lanes 1 and 2 go along the line; the left one, 2, is 5.25 m left of it.
    both = section(left=lane(2) + lane(1), right=lane(-1) + lane(-2))
    plan = geometry('<arc curvature="0.004"/>', 400)
    read = read_road(write(tmp_path, road(plan, both, 'rule="LHT"')))
    assert read.road.traffic == "left"
    assert bends(read, 200) == pytest.approx([1 / 244.75], rel=1e-5)


def test_a_spiral_is_a_clothoid(tmp_path: Path) -> None:
    plan = geometry('<spiral curvStart="0" curvEnd="0.005"/>', 200)
    lanes = f'<laneOffset s="0" a="1.75" b="0" c="0" d="0"/>{TWO}'
    read = read_road(write(tmp_path, road(plan, lanes)))
    # The reference line itself is the left lane's centre: curvature s * 2.5e-5.
    assert bends(read, 50, 100, 150) == pytest.approx([0.00125, 0.0025, 0.00375], 1e-3)
    # Fresnel integrals say where a clothoid ends.
    scale = math.sqrt(math.pi / 2.5e-5)
    sine, cosine = fresnel(200.0 / scale)
    station = np.linspace(0.0, 200.0, 20001)
    bend = curvatures(read.road.stations, station)
    heading = np.concatenate([[0], np.cumsum((bend[1:] + bend[:-1]) / 2 * 0.01)])
    end = np.sum(np.exp(1j * (heading[1:] + heading[:-1]) / 2)) * 0.01
    assert abs(end - complex(cosine, sine) * scale) < 0.05


def cubic(prange: str) -> str:
    """A parabola v = u²/1000 over 200 m, by either parameter."""
    reach = 200.0 if prange == "arcLength" else 1.0
    u, v = 200.0 / reach, 40.0 / reach**2
    return (
        f'<paramPoly3 pRange="{prange}" aU="0" bU="{u}" cU="0" dU="0" '
        f'aV="0" bV="0" cV="{v}" dV="0"/>'
    )


@pytest.mark.parametrize("shape", ["poly3", "arcLength", "normalized"])
def test_polynomials_have_their_curvature(shape: str, tmp_path: Path) -> None:
    slope = np.polyder([1e-3, 0.0, 0.0])
    u = np.linspace(0.0, 200.0, 20001)
    length = float(np.trapezoid(np.hypot(1.0, np.polyval(slope, u)), u))
    given = '<poly3 a="0" b="0" c="0.001" d="0"/>' if shape == "poly3" else cubic(shape)
    lanes = f'<laneOffset s="0" a="1.75" b="0" c="0" d="0"/>{TWO}'
    if shape == "arcLength":  # its p ends at the length, which so is that of p
        length = 200.0
        given = given.replace('cV="0.001"', 'cV="0.0001"')
    read = read_road(write(tmp_path, road(geometry(given, length), lanes)))
    c = 1e-4 if shape == "arcLength" else 1e-3
    # In the middle of the length u is about 101 m; the curvature of y = c u² there:
    middle = float(
        np.interp(read.road.length / 2, np.cumsum(np.hypot(1, 2 * c * u)) * 0.01, u)
    )
    expected = 2 * c / (1 + (2 * c * middle) ** 2) ** 1.5
    assert bends(read, read.road.length / 2) == pytest.approx([expected], rel=0.01)


def test_a_lane_of_the_other_direction_is_that_to_overtake_in(tmp_path: Path) -> None:
    one = section(left=lane(1), right=lane(-1))
    read = read_road(write(tmp_path, road(straight(), one)))
    assert read.road.lanes == 2
    assert "is read as the lane to overtake in" in read.notes[0]


def test_a_lane_that_ends_is_left_out_and_named(tmp_path: Path) -> None:
    link = '<link><successor id="-1"/></link>'
    first = section(right=lane(-1, more=link) + lane(-2) + lane(-3))
    lanes = f"{first}\n{section(right=lane(-1) + lane(-2), s=300)}"
    read = read_road(write(tmp_path, road(straight(), lanes)))
    assert read.road.lanes == 2
    assert any("lane -3 does not go from end to end" in each for each in read.notes)


def test_what_is_not_modelled_is_named_with_its_line(tmp_path: Path) -> None:
    inside = (
        '<elevationProfile>\n<elevation s="0" a="0" b="0.02" c="0" d="0"/>\n'
        "</elevationProfile>\n<lateralProfile>\n"
        '<superelevation s="0" a="0.03" b="0" c="0" d="0"/>\n</lateralProfile>\n'
    )
    uneven = section(right=lane(-1, 3.9) + lane(-2, 3.5) + lane(-3, 2, "biking"))
    plan = straight(250) + "\n" + LINE.format(s=250, x=250.5, length=250)
    file = write(tmp_path, road(plan, uneven, inside=inside))
    notes = "\n".join(read_road(file).notes)
    for told in (
        "line 10: elevation: the road is read as flat",
        "line 13: superelevation: the road is read as level",
        "line 7: geometry begins 0.5 m from the end of the one before",
        "line 16: lanes of type biking are not read",
        "lanes are 3.50 to 3.90 m wide; all are read as 3.700 m",
    ):
        assert told in notes


@pytest.mark.parametrize(
    ("said", "told"),
    [
        ('length="500"', ""),
        ('length="500.4"', ""),
        ('length="600"', "has the length 600 m; its geometry of 500 m is read"),
        ("", "has no length; its geometry of 500 m is read"),
        ('length="-1"', "has the length -1 m; its geometry of 500 m is read"),
    ],
)
def test_the_road_is_as_long_as_its_geometry(
    said: str, told: str, tmp_path: Path
) -> None:
    text = road(straight()).replace('length="500"', said, 1)
    read = read_road(write(tmp_path, text))
    assert read.road.length == 500.0
    assert [f"the road {told}" in each for each in read.notes] == [True] * bool(told)


def test_a_road_that_does_not_begin_at_its_start_is_told(tmp_path: Path) -> None:
    file = write(tmp_path, road(LINE.format(s=50, x=50, length=450)))
    told = "the road has the length 500 m; its geometry of 450 m is read"
    assert told in read_road(file).notes[0]


def test_borders_are_as_good_as_widths(tmp_path: Path) -> None:
    given = section(right=border(-1, -3.0) + border(-2, -6.0))
    read = read_road(write(tmp_path, road(straight(), given)))
    assert (read.road.lane_width, read.notes) == (3.0, ())


def test_a_stretch_without_geometry_is_told(tmp_path: Path) -> None:
    plan = straight(250) + "\n" + LINE.format(s=260, x=260, length=240)
    notes = read_road(write(tmp_path, road(plan))).notes
    assert any("line 6: geometry ends at s = 250 m, the next" in n for n in notes)


SPEED = '<type s="0" type="rural">\n<speed max="{}" unit="{}"/></type>\n'


def test_a_speed_limit_is_read_in_its_unit(tmp_path: Path) -> None:
    limit = SPEED.format(60, "mph")
    assert (
        read_road(write(tmp_path, road(straight(), inside=limit))).road.speed_limit
        == "60 mph"
    )


REFUSED = [
    (
        road("<geometry s='0' x='0' y='0' hdg='0' length='9'><bezier/></geometry>"),
        6,
        "bezier is not read",
    ),
    (road(straight().replace('hdg="0"', 'hdg="nan"')), 6, "hdg of <geometry> is 'nan'"),
    (
        road(straight().replace('length="500.0"', "")),
        6,
        "length of <geometry> is missing",
    ),
    (road(straight(1e9)), 6, "length of <geometry> is '1000000000.0'; give a number"),
    (road(straight(1e7)), 4, "give at most 200 km"),
    (
        road(straight(), TWO.replace('c="0" d="0"', 'c="0" d="1"')),
        4,
        "its lanes are 6.25e+07 m long",
    ),
    (road(straight(), section(right=lane(-1))), 4, "1 lanes are driven on"),
    (
        road(straight(), section(right=lane(-1) + lane(-2, 3, "median") + lane(-3))),
        9,
        "between lanes -3 and -1 lie others",
    ),
    (road(straight(), section(right=lane(-2) + lane(-3))), 9, "without lane -1"),
    (road(straight(), TWO, 'rule="XYZ"'), 4, "give RHT or LHT"),
    (
        road(straight(), TWO, inside=SPEED.format(5, "knots")),
        9,
        "'knots' is no unit of speed; give one of km/h",
    ),
    (road(straight(), TWO.replace('id="-1"', 'id="1"')), 9, "positive on the left"),
    (road(geometry('<arc curvature="-5"/>', 9)), 6, "a radius of 0.2 m; give 5 m"),
    (
        road(straight(), section(right=lane(-1, -3) + lane(-2))),
        9,
        "lane -1 is -3 m wide at s = 0 m; give 0 or more",
    ),
    (
        road(straight()).replace('length="500"', 'length="nan"'),
        4,
        "length of <road> is 'nan'",
    ),
    (road(straight()) + "<include file='x'/>", 12, "<include> is not read"),
    ("<road", 4, "no XML"),
    ("", 2, "no road; give one"),
    (
        road(straight(), section(right=border(-1, 3.5) + border(-2, 7.0))),
        9,
        "lane -1 is -3.5 m wide at s = 0 m; give 0 or more",
    ),
    (
        road(straight(), section(right=lane(-1) + lane(-1, 6.0) + lane(-2))),
        9,
        "two lanes have the id -1; give each its own",
    ),
    (
        road(straight(), section(right=lane(-1) + lane(-2), s=100)),
        9,
        "lanes begin at s = 100 m; give 0",
    ),
    (road(straight(), f"{TWO}\n{TWO}"), 10, "begins at s = 0 m; give 0 or more"),
    (
        road(LINE.format(s=-50, x=0, length=550)),
        6,
        "begins at s = -50 m; give 0 or more, in rising order",
    ),
    (road(straight(0.0)), 6, "geometry of length 0 m; give more"),
]


@pytest.mark.parametrize("speed", [-5, 900])
def test_a_speed_limit_that_nobody_means_is_left_out(
    speed: int, tmp_path: Path
) -> None:
    limit = SPEED.format(speed, "km/h")
    read = read_road(write(tmp_path, road(straight(), inside=limit)))
    assert read.road.speed_limit == ""
    assert f"line 9: the speed limit {speed} km/h is left out" in read.notes[0]


@pytest.mark.parametrize("encoding", ["gb2312", "idna", "nothing"])
def test_another_encoding_is_named_with_the_file(encoding: str) -> None:
    text = f'<?xml version="1.0" encoding="{encoding}"?><OpenDRIVE/>'.encode()
    with pytest.raises(ValueError, match=r"^a\.xodr is in an encod.*as UTF-8$"):
        parsed_tree(text, "a.xodr")


@pytest.mark.parametrize(
    ("text", "line", "told"), REFUSED, ids=[t for *_, t in REFUSED]
)
def test_what_cannot_be_read_is_refused_with_its_line(
    text: str, line: int, told: str, tmp_path: Path
) -> None:
    with pytest.raises(ValueError, match=rf"road\.xodr, line {line}: ") as refused:
        read_road(write(tmp_path, text))
    assert told in str(refused.value)


def test_of_several_roads_one_is_named(tmp_path: Path) -> None:
    other = road(straight(200)).replace('id="1"', 'id="7"', 1)
    file = write(tmp_path, road(straight()), other)
    with pytest.raises(ValueError, match=r"give --road with one of 1 \(500 m\), 7"):
        read_road(file)
    with pytest.raises(ValueError, match="there is no road '3'"):
        read_road(file, "3")
    assert read_road(file, "7").road.length == 200.0


def test_a_bomb_does_not_go_off() -> None:
    entities = "".join(
        f'<!ENTITY {chr(98 + k)} "{("&" + chr(97 + k) + ";") * 10}">' for k in range(20)
    )
    text = f'<!DOCTYPE x [<!ENTITY a "aaaa">{entities}]><OpenDRIVE>&t;</OpenDRIVE>'
    begun = time.process_time()
    with pytest.raises(ValueError, match="document type"):
        parsed_tree(text.encode(), "bomb.xodr")
    outside = b'<!DOCTYPE x SYSTEM "file:///etc/passwd"><OpenDRIVE/>'
    with pytest.raises(ValueError, match="document type"):
        parsed_tree(outside, "outside.xodr")
    with pytest.raises(ValueError, match="more than a road has"):
        parsed_tree(b"<a>" * 200, "deep.xodr")
    assert time.process_time() - begun < 1.0


@pytest.mark.parametrize("traffic", ["left", "right"])
@pytest.mark.parametrize("name", shipped())
def test_an_exported_road_is_read_again(
    name: str, traffic: str, tmp_path: Path
) -> None:
    scenario = scenario_named(name)
    own = scenario.road._replace(traffic=traffic)
    file = tmp_path / "own.xodr"
    file.write_text(road_text(scenario._replace(road=own)), encoding="utf-8")
    read = read_road(file)
    assert read.notes == ()
    assert read.road.length == pytest.approx(own.length, abs=0.01)
    alike = read.road._replace(stations=(), length=own.length)
    assert alike == own._replace(stations=())
    places = np.arange(0.0, own.length, 10.0)
    apart = curvatures(read.road.stations, places) - curvatures(own.stations, places)
    # 2e-5 is a radius of 500 m for one of 505 m, where a clothoid meets an arc.
    assert np.abs(apart).max() < 2e-5


def test_an_exported_curve_is_at_the_place_of_its_circle(tmp_path: Path) -> None:
    quarter = 500.0 * math.pi / 2.0
    arc = Road(length=quarter, stations=(Bent(0.0, 500.0),))
    text = road_text(Scenario("arc", road=arc))
    (tmp_path / "a.xodr").write_text(text, encoding="utf-8")
    assert f'<arc curvature="{1 / 500.0!r}"/>' in text
    assert 'rule="LHT"' in text
