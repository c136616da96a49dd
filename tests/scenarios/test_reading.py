"""Scenario files: what is read, and what is refused with its line and the way out."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest
import yaml
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import costeer
from costeer.scenarios.definition import Bent, Road, Scenario, speed_of
from costeer.scenarios.reading import (
    checked,
    chosen,
    parsed,
    read_scenario,
    scenario_named,
    scenario_of,
    shipped,
    shipped_text,
)
from costeer.scenarios.writing import plain, scenario_text, template

SOUND = """\
name: bend
speed: 80 km/h
road:
  length: 3000
  lanes: 2
  stations:
    - {at: 300}
    - {at: 400, radius: 600}
overtaking: {cars: 1, first: 500}
actors:
  - name: first
    lane: 0
    at: 500
    speed: 70 km/h
    orders:
      - {when: {gap: 32}, lane: 1}
  - {name: load, kind: obstacle, lane: 1, appears: {place: 900}, headway: 2.5}
events:
  - {kind: gust, at: 1300, length: 60, force: 1200}
zones:
  - {name: curve, start: 400, end: 900}
mistakes:
  - {kind: torque-bias, size: 0.3}
"""

# What is put in the place of what, the line that is named, and words of the message.
WRONG = [
    ("speed: 80 km/h", "sped: 80 km/h", 2, "did you mean speed"),
    ("speed: 80 km/h", "speed: 80", 2, "a number without a unit is in m/s"),
    ("speed: 80 km/h", "speed: fast", 2, "is no speed"),
    ("speed: 80 km/h", "speed: 20 km/h", 2, "give 43.2 to 111.6 km/h"),
    ("name: bend", "name: Bend!", 1, "small letters"),
    ("size: 0.3", "size: .nan", 23, "size is .nan; give a number"),
    ("size: 0.3", "size: 9", 23, "give a number from -3 to 3"),
    ("torque-bias, size: 0.3", "wrong-side", 23, "needs three lanes or more"),
    ("torque-bias, size: 0.3", "head-lost, size: 1", 23, "has no size"),
    ("torque-bias", "torque-bais", 23, "did you mean torque-bias"),
    ("lanes: 2", "lanes: 1", 5, "from 2 to 6"),
    ("lanes: 2", "lanes: 2.5", 5, "a whole number"),
    ("lanes: 2", "lanes: " + "9" * 500, 5, "from 2 to 6"),
    ("length: 3000", "length: .nan", 4, "length is .nan; give a number"),
    ("length: 3000", "length: .inf", 4, "length is .inf; give a number"),
    ("length: 3000", "length: yes", 4, "give a number"),
    ("length: 3000", "length: 3000, length: 1", 4, ""),
    ("radius: 600", "radius: 60", 8, "too tight for 80 km/h; give 165 m"),
    ("radius: 600", "radius: 0", 8, "radius of 0 m is none"),
    ("radius: 600", "radius: .inf", 8, "leave it out"),
    ("{at: 400, radius: 600}", "{at: 200, radius: 600}", 8, "rising order"),
    ("{at: 400, radius: 600}", "{at: 4000, radius: 600}", 8, "not on the road"),
    ("first: 500", "first: 5000", 9, "would appear at 5000 m"),
    ("first: 500", "first: -1", 9, "from 0 to 200000"),
    ("lane: 0", "lane: 2", 12, "lane 2, which is not there; give 0 (right)"),
    ("    at: 500", "    at: 5000", 13, "outside the road of 3000 m"),
    ("    at: 500", "    at: 500\n    offset: .nan", 14, "offset is .nan; give"),
    ("    at: 500", "    at: 500\n    length: -4", 14, "length is -4"),
    ("speed: 70 km/h", "speed: 70 mpg", 14, "is no speed"),
    ("{gap: 32}", "{gap: 32, time: 3}", 16, "a moment says time and gap"),
    ("{gap: 32}", "{}", 16, "a moment says nothing"),
    ("{gap: 32}", "{place: 4000}", 16, "can never be on a road of 3000 m"),
    ("{gap: 32}", "{time: 900}", 16, "the drive is over by then"),
    ("{gap: 32}", "{time_to_collision: .inf}", 16, "time_to_collision is .inf; give"),
    ("{gap: 32}, lane: 1", "{gap: 32}, lane: 7", 16, "lane 7, which is not there"),
    ("{gap: 32}, lane: 1", "{gap: 32}", 16, "neither speed nor lane"),
    ("name: load", "name: first", 17, "stands twice in actors"),
    ("kind: obstacle", "kind: obstacel", 17, "did you mean obstacle"),
    ("headway: 2.5", "headway: 99", 17, "from 0.3 to 60"),
    ("place: 900", "place: 2990", 17, "would appear at 3046 m, outside the road"),
    ("at: 1300", "at: 3300", 19, "can never happen on a road of 3000 m"),
    (", force: 1200", "", 19, "no force"),
    ("kind: gust", "kind: gsut", 19, "did you mean gust"),
    ("end: 900", "end: 300", 21, "from 400 to 300 m"),
    ("end: 900", "ende: 900", 21, "did you mean end"),
    ("speed: 80 km/h", "speed: 80 km/h\nspeed: 9", 3, "line 3: speed stands twice"),
    ("  lanes: 2", "\tlanes: 2", 5, "a tab indents this line"),
    ("  lanes: 2", "  <<: {lanes: 2}", 5, "<< is not read"),
    ("name: bend", "name: !!python/name:os.system", 1, "tags (!!...) are not read"),
    ("zones:", "---\nzones:", 20, "a second document"),
    ("name: bend", "name: bend: er", 1, "a colon too many"),
    ("name: bend", "name: be\0nd", 1, "a control character"),
    ("name: bend", 'name: bend\nabout: "a\\x07b"', 2, "control characters"),
    (
        "length: 3000",
        "length: 03000",
        4,
        "length is 03000, which is read as 1536; write",
    ),
    (
        "length: 3000",
        "length: 50:00",
        4,
        "50:00, which is read as 3000; write the number",
    ),
    (
        "length: 3000",
        "length: 0xBB8",
        4,
        "0xBB8, which is read as 3000; write the number",
    ),
    ("at: 1300", "at: 21:40.0", 19, "at is 21:40.0, which is read as 1300.0; write"),
    ("radius: 600", "radius: .NaN", 8, "radius is .NaN; give a number, or leave"),
    ("headway: 2.5", "headway: .nan", 17, "headway is .nan; give"),
    ("name: bend", "name: .nan", 1, "name is .nan; give"),
    ("name: bend", "name: 0100", 1, "or put it in quotes"),
    ("name: bend", "name: .inf", 1, "name is .inf; give"),
    ("speed: 80 km/h", "about: -.INF", 2, "about is -.INF; give"),
    ("length: 3000", "length: 1.0e+999", 4, "length is 1.0e+999; give"),
    ("length: 3000", "length: !!int abc", 4, "length is abc; give a number"),
    ("length: 3000", "length: !!float abc", 4, "length is abc; give a number"),
    ("length: 3000", "length: " + "9" * 5000, 4, "give a number"),
    ("name: bend", "name: bend\n.nan: 1", 2, ".nan; give a number"),
    ("{at: 300}", "{at: -3}", 7, "is not on the road; give 0 to 3000 m"),
    ("  lanes: 2", "  lanes:", 5, "lanes has no value"),
    ("length: 3000", "length: 3e3", 4, "a number without an exponent"),
    ("name: bend", "name: &n bend\nabout: *n", 2, "references are not read"),
]


@pytest.mark.parametrize("name", shipped())
def test_a_scenario_that_ships_is_short_and_its_text_says_the_same(name: str) -> None:
    assert len(shipped_text(name).splitlines()) <= 30
    scenario = scenario_named(name)
    assert scenario.name == name
    told = plain(scenario)
    assert plain(parsed(scenario_text(scenario), name)) == told
    assert plain(scenario_of(json.loads(json.dumps(told, allow_nan=False)))) == told


def test_the_paper_s_scenario_is_what_the_paper_says() -> None:
    # Sec. III-B: two lanes, 8 km, 70 km/h, four slower cars.
    paper = scenario_named("expressway")
    assert (paper.road.lanes, paper.road.length) == (2, 8000.0)
    assert (paper.overtaking.cars, paper.road.stations) == (4, ())
    assert speed_of(paper.speed) == 70.0 / 3.6  # bit for bit


@pytest.mark.parametrize(
    ("text", "speed"),
    [("90 km/h", 25.0), ("25 m/s", 25.0), ("25", 25.0), ("50 mph", 22.352)],
)
def test_a_speed_has_a_unit(text: str, speed: float) -> None:
    assert speed_of(text) == pytest.approx(speed, abs=1e-12)


def test_the_sound_file_is_read() -> None:
    scenario = parsed(SOUND, "bend.yaml")
    assert scenario.actors[0].orders[0].when.gap == 32.0
    assert scenario.road.stations[1] == Bent(400.0, 600.0)


@pytest.mark.parametrize(
    ("right", "wrong", "line", "told"), WRONG, ids=[w for _, w, *_ in WRONG]
)
def test_what_cannot_be_is_refused_with_its_line(
    right: str, wrong: str, line: int, told: str
) -> None:
    assert SOUND.count(right) >= 1
    with pytest.raises(ValueError, match=f"line {line}[:,]") as refused:
        parsed(SOUND.replace(right, wrong, 1), "bend.yaml")
    assert told in str(refused.value)


def test_bytes_that_are_no_utf_8_are_refused_with_their_line() -> None:
    with pytest.raises(ValueError, match=r"^x.yaml, line 2: byte 0xff is no UTF-8"):
        parsed(b"name: x\nabout: \xff\n", "x.yaml")


def test_too_many_actors_are_counted() -> None:
    actors = "".join(f"  - {{name: a{k}, at: {50 * k}}}\n" for k in range(1, 43))
    with pytest.raises(ValueError, match=r"x.yaml, line 43: 42 actors; give at most"):
        parsed(f"name: x\nactors:\n{actors}", "x.yaml")


def test_cars_in_one_place_are_refused() -> None:
    beside = SOUND.replace("    lane: 0\n    at: 500", "    lane: 1\n    at: 3")
    beside = beside.replace("{gap: 32}, lane: 1", "{gap: 32}, lane: 0")
    with pytest.raises(ValueError, match=r"line 13: first and the driven car"):
        parsed(beside, "bend.yaml")
    # Two cars of 1.8 m fit beside each other in a lane of 3.5 m.
    apart = beside.replace(
        "    at: 3\n", "    at: 3\n    offset: 1.7\n    width: 0.9\n"
    )
    assert parsed(apart, "bend.yaml").actors[0].offset == 1.7


def test_a_lane_change_into_no_lane_can_never_happen() -> None:
    asked = "name: a\nevents:\n  - {kind: lane-change, at: 500, side: left}\n"
    with pytest.raises(ValueError, match=r"line 3: .* can never happen"):
        parsed(asked, "a.yaml")  # left-hand traffic: one drives in the left lane
    assert parsed(asked.replace("left", "right"), "a.yaml").events[0].side == "right"


def test_the_inner_lane_of_a_curve_is_what_is_too_tight() -> None:
    # 80 km/h on 165 m is 3 m/s²; the right lane of a right curve is 3.5 m tighter.
    with pytest.raises(ValueError, match=r"give 168 m or more"):
        parsed(SOUND.replace("radius: 600", "radius: -166"), "bend.yaml")
    assert parsed(SOUND.replace("radius: 600", "radius: 166"), "bend.yaml")


@pytest.mark.parametrize(
    "text",
    [
        b"",
        b"- 1\n",
        b"name: &a [x]\nabout: *a\n",
        b"name: !!bool x\n",
        b"name: !!int ''\n",
        b"name: !!python/object:os.system x\n",
        b"\xff\xfe\x00",
        b"[" * 700,
        b"name: x\nroad: {length: 1" + b"0" * 400 + b"}\n",
        b"name: " + b"x" * 100_000 + b"\n",
    ],
    ids=range(10),
)
def test_what_is_no_scenario_is_refused_in_one_line(text: bytes) -> None:
    with pytest.raises(ValueError, match=r"x\.yaml") as refused:
        parsed(text, "x.yaml")
    assert len(str(refused.value)) < 600


def test_an_empty_file_is_called_empty() -> None:
    for text in ("", "# nothing but this\n"):
        with pytest.raises(ValueError, match=r"^x\.yaml is empty; give names") as told:
            parsed(text, "x.yaml")
        assert "costeer scenario new FILE.yaml writes a file to begin" in str(
            told.value
        )


@pytest.mark.parametrize("given", [None, 5, {}, [], b"expressway", 1.5])
def test_what_is_no_scenario_at_all_is_named(given: object, tmp_path: Path) -> None:
    told = f"scenario is {given!r}; give a name, such as expressway, a file"
    for call in (
        lambda: scenario_named(given),  # type: ignore[arg-type]  # on purpose
        lambda: costeer.simulate(scenario=given),  # type: ignore[arg-type]
        lambda: costeer.study(tmp_path / "a", scenario=given),  # type: ignore[arg-type]
    ):
        with pytest.raises(ValueError, match=f"^{re.escape(told)}"):
            call()


def test_lists_do_as_tuples_and_a_path_as_its_text(tmp_path: Path) -> None:
    bent = [Bent(100.0), Bent(200.0, 600.0)]
    road = Road(length=1000.0, stations=bent)  # type: ignore[arg-type]  # a list
    mine = Scenario("mine", road=road, zones=[])  # type: ignore[arg-type]  # as above
    assert chosen(mine, None, None).scenario.road.stations == tuple(bent)
    file = tmp_path / "mine.yaml"
    file.write_text(scenario_text(mine), encoding="utf-8")
    record = costeer.simulate("manual", scenario=file, length=120.0, intention="off")
    driven = scenario_of(record.metadata["scenario"])  # type: ignore[arg-type]  # JSON
    assert plain(driven) == plain(checked(mine))


def test_a_curvature_that_jumps_is_told() -> None:
    # From 170 m to the left to 170 m to the right is 0.01176 1/m; at 72 km/h and
    # 25 m/s³ that takes 20³ x 0.01176 / 25 m = 3.8 m.
    def told(apart: float) -> tuple[str, ...]:
        stations = (Bent(100.0, 170.0), Bent(100.0 + apart, -170.0))
        road = Road(length=1000.0, stations=stations)
        return chosen(Scenario("a", speed="72 km/h", road=road), None, None).notes

    assert "stations 3.8 m apart" in told(0.001)[0]
    assert len(told(3.7)) == 1
    assert told(3.8) == ()
    assert "from 100 to 100.0000001 m;" in told(1e-7)[0]


def test_of_many_jumps_the_first_is_told() -> None:
    stations = tuple(Bent(100.0 + k, 200.0 * (-1) ** k) for k in range(9))
    road = Road(length=1000.0, stations=stations)
    (note,) = chosen(Scenario("a", road=road), None, None).notes
    assert "from 100 to 101 m (and in 7 more places)" in note


def test_a_huge_file_is_not_read(tmp_path: Path) -> None:
    file = tmp_path / "huge.yaml"
    file.write_bytes(b"# " + b"x" * 10_000_000)
    with pytest.raises(ValueError, match=r"10 MB, at most 0\.2 MB are read"):
        read_scenario(file)


def outcome(text: str) -> Scenario | str:
    """The scenario of a text, or why there is none; anything else is a mistake."""
    try:
        return parsed(text, "x.yaml")
    except ValueError as refused:
        return str(refused)


PIECES = ["name", "road", "at", "radius", "- ", "{", "}", "[", ": ", "\n", "  ", "&a"]
PIECES += ["*a", ".nan", "-1", "1e999", "!!set", "~", "'", "|", "9" * 30, "km/h", "#"]


@settings(suppress_health_check=[HealthCheck.too_slow])
@given(st.data())
def test_damaged_text_is_read_or_refused(data: st.DataObject) -> None:
    text = SOUND
    for _ in range(data.draw(st.integers(1, 4))):
        at = data.draw(st.integers(0, len(text)))
        gone = data.draw(st.integers(0, 6))
        text = text[:at] + data.draw(st.sampled_from(PIECES)) + text[at + gone :]
    read = outcome(text)
    if isinstance(read, Scenario):
        assert plain(parsed(scenario_text(read), "again")) == plain(read)


VALUES = st.one_of(
    st.none(),
    st.booleans(),
    st.integers(-(10**40), 10**40),
    st.floats(),
    st.text(max_size=5),
    st.lists(st.integers(), max_size=2),
)


@given(st.data())
def test_any_value_at_any_place_is_read_or_refused(data: st.DataObject) -> None:
    content = yaml.safe_load(SOUND)
    part = content
    while True:
        keys = range(len(part)) if isinstance(part, list) else sorted(part)
        key = data.draw(st.sampled_from(keys))
        inner = part[key]
        if not isinstance(inner, dict | list) or not inner or data.draw(st.booleans()):
            part[key] = data.draw(VALUES)
            break
        part = inner
    text = yaml.safe_dump(content, sort_keys=False, allow_unicode=True)
    read = outcome(text)
    assert isinstance(read, Scenario) or "x.yaml" in read


def test_objects_are_judged_as_files_are() -> None:
    with pytest.raises(ValueError, match="lanes is 9"):
        checked(Scenario("a", road=Road(lanes=9)))
    wrong: object = 5
    with pytest.raises(ValueError, match="road is 5"):
        checked(Scenario("a", road=wrong))  # type: ignore[arg-type]  # on purpose


def test_length_and_speed_are_the_scenario_s_unless_given() -> None:
    own = chosen("cut-in", None, None)
    assert (own.length, own.speed) == (3000.0, 80.0 / 3.6)
    asked = chosen("cut-in", 1000.0, 25.0)
    assert (asked.length, asked.speed) == (1000.0, 25.0)
    assert "second (1575 m)" in asked.notes[0]
    with pytest.raises(ValueError, match="too tight for 144 km/h"):
        chosen("expressway-curves", None, 40.0)


def test_every_example_of_the_template_is_sound() -> None:
    text = template(Scenario("new", about="x"))
    assert parsed(text, "new.yaml").overtaking.cars == 1
    rest = text[text.index("\nname: new") :]
    shown = re.sub(
        r"^( *)# (stream|actors|events|zones|stations|  )", r"\1\2", rest, flags=re.M
    )
    full = parsed(shown, "new.yaml")
    assert (len(full.actors), len(full.events), len(full.zones)) == (2, 1, 1)
    assert (len(full.road.stations), full.stream.cars) == (4, 12)
