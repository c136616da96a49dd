"""Messages of a page: the right ones are understood, all others refused in words."""

from __future__ import annotations

import json
import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from costeer.web import intake
from costeer.web.messages import (
    Acknowledge,
    Indicator,
    Input,
    Latency,
    Pause,
    Ping,
    Restart,
    Resume,
    Set,
    Start,
    Stop,
    encoded,
    parse_message,
)

INPUT = {"type": "input", "sequence": 7, "steer": -1, "accelerator": 0.5, "brake": 0}

JSON_VALUES = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(),
    lambda inner: st.lists(inner) | st.dictionaries(st.text(), inner),
    max_leaves=5,
)
TYPES = ["input", "ping", "start", "indicator", "latency", "set"]
FIELDS = [
    "sequence",
    "steer",
    "accelerator",
    "brake",
    "t",
    "side",
    "values",
    "name",
    "value",
]


def changed(**fields: object) -> str:
    return json.dumps(INPUT | fields)


def refused(text: str | bytes) -> str:
    with pytest.raises(ValueError, match=r".") as caught:
        parse_message(text)
    return str(caught.value)


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        (INPUT, Input(sequence=7, steer=-1.0, accelerator=0.5, brake=0.0)),
        ({"type": "ping", "t": 12.5}, Ping(t=12.5)),
        ({"type": "start"}, Start()),
        ({"type": "pause"}, Pause()),
        ({"type": "resume"}, Resume()),
        ({"type": "acknowledge"}, Acknowledge()),
        ({"type": "indicator", "side": -1}, Indicator(side=-1)),
        ({"type": "latency", "values": [20, 30.5]}, Latency(values=(20.0, 30.5))),
        ({"type": "set", "name": "gain", "value": 2}, Set(name="gain", value=2.0)),
        ({"type": "set", "name": "method", "value": "ibhs"}, Set("method", "ibhs")),
        ({"type": "restart"}, Restart()),
        ({"type": "stop"}, Stop()),
    ],
)
def test_every_message_is_understood(
    fields: dict[str, object], message: object
) -> None:
    parsed = parse_message(json.dumps(fields))
    # Tuples of two types may be equal; the type is what the session goes by.
    assert (type(parsed), parsed) == (type(message), message)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        (b"{}", "binary"),
        ("", "no JSON"),
        ("[1]", "JSON object"),
        ("{}", "type is None"),
        ('{"type":["input"]}', "type is"),
        ('{"type":"fly"}', "known are input, ping"),
        ('{"type":"start","now":1}', "unknown field 'now'"),
        ('{"type":"ping"}', "lacks t"),
        ('{"type":"ping","t":NaN}', "NaN is no number"),
        ('{"type":"ping","t":-Infinity}', "-Infinity is no number"),
        ('{"type":"ping","t":1e999}', "t is inf"),
        ('{"type":"ping","t":1' + "0" * 400 + "}", "t is 1000"),
        ('{"type":"ping","t":1,"t":2}', "twice"),
        ('{"type":"ping","t":true}', "t is True; give a number"),
        (changed(steer=1.001), "steer is 1.001; give a number from -1 to 1"),
        (changed(brake="0"), "brake is '0'; give a number"),
        (changed(accelerator=None), "accelerator is None"),
        (changed(sequence=1.0), "sequence is 1.0; give a whole number"),
        (changed(sequence=2**53), "sequence is 9007199254740992"),
        (changed(sequence=-1), "sequence is -1"),
        ('{"type":"indicator","side":2}', "side is 2; give a number from -1 to 1"),
        ('{"type":"latency","values":1}', "give a list"),
        ('{"type":"latency","values":["1"]}', "each of values is '1'"),
        (json.dumps({"type": "latency", "values": [0] * 61}), "at most 60"),
        ('{"type":"set","name":"","value":1}', "1 to 64 printable"),
        ('{"type":"set","name":3,"value":1}', "name is 3; give a name"),
        ('{"type":"set","name":"method","value":"\\n"}', "1 to 64 printable"),
        ('{"type":"set","name":"method","value":null}', "value is None; give a num"),
    ],
)
def test_what_is_wrong_is_said(text: str | bytes, told: str) -> None:
    assert told in refused(text)


def test_1024_bytes_are_read_and_one_more_is_not() -> None:
    text = '{"type":"start"}'
    assert parse_message(text.ljust(1024)) == Start()
    assert "1025 bytes" in refused(text.ljust(1025))
    # Bytes count, not letters: the umlaut has two.
    assert "1025 bytes" in refused("ä".ljust(1024))


@given(JSON_VALUES.map(json.dumps) | st.text() | st.binary())
def test_nothing_raises_anything_but_value_errors(text: str | bytes) -> None:
    with pytest.raises(ValueError, match=r"."):
        parse_message(text)


@given(st.sampled_from(TYPES), st.dictionaries(st.sampled_from(FIELDS), JSON_VALUES))
def test_messages_with_wrong_values_raise_value_errors_or_are_finite(
    kind: str, fields: dict[str, object]
) -> None:
    try:
        message = parse_message(json.dumps({"type": kind} | fields))
    except ValueError:
        return
    numbers = [value for value in message if isinstance(value, float)]
    assert all(map(math.isfinite, numbers))


def test_a_deep_nest_is_refused_in_words() -> None:
    # Which of the two depends on how deep this Python reads.
    told = refused("[" * 1000)
    assert "nested too deeply" in told or "no JSON" in told


def test_text_that_is_no_unicode_is_refused() -> None:
    assert "no JSON" in refused("\ud800")


def test_answers_have_null_where_json_has_no_number() -> None:
    answer: dict[str, object] = {"a": math.nan, "b": [math.inf, 1], "c": {"d": "ö"}}
    text = encoded(answer)
    assert json.loads(text) == {"a": None, "b": [None, 1], "c": {"d": "ö"}}


def admitted(times: list[float]) -> int:
    """How many messages that come at these times [s] may be read."""
    parameters = intake.IntakeParameters()
    state, count = intake.initial_state(parameters, 0.0), 0
    for time in times:
        state, may = intake.admit(parameters, state, time)
        count += may
    return count


def test_500_messages_a_second_are_admitted_for_ever() -> None:
    times = [number / 500.0 for number in range(5000)]
    assert admitted(times) == 5000


def test_a_flood_is_cut_to_the_rate() -> None:
    # 1,000 a second for 4 s: the burst of 500, then half of what comes. One more or
    # less by rounding.
    times = [number / 1000.0 for number in range(4000)]
    assert admitted(times) == pytest.approx(500 + 2000, abs=1)


def test_a_clock_that_goes_back_earns_nothing() -> None:
    assert admitted([1.0] * 100 + [0.5] * 600) == 500


def test_a_socket_is_exhausted_by_the_20th_refusal() -> None:
    parameters = intake.IntakeParameters()
    state = intake.initial_state(parameters, 0.0)
    for _ in range(19):
        state = intake.refuse(state)
    assert not intake.is_exhausted(parameters, state)
    assert intake.is_exhausted(parameters, intake.refuse(state))
