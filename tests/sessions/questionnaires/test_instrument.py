"""Instruments and texts fit together, in every language, and a lab can change them."""

from __future__ import annotations

import itertools
import json
import re
from pathlib import Path

import pytest
import yaml

from costeer.sessions.questionnaires.answers import Code
from costeer.sessions.questionnaires.definition import (
    instrument_names,
    load_definition,
    own_folder,
)
from costeer.sessions.questionnaires.instrument import (
    load_instrument,
    rendered,
    text_hash,
    unfilled,
)
from costeer.sessions.questionnaires.texts import languages, load_texts

EVERY = list(itertools.product(instrument_names(), ("de", "en", "ja")))
PLACE = re.compile(r"\{(\w+)\}")


def write(folder: Path, name: str, content: object) -> Path:
    """A YAML file in a study folder."""
    path = folder / name
    path.parent.mkdir(exist_ok=True)
    path.write_text(yaml.safe_dump(content, allow_unicode=True), "utf-8")
    return folder


def names(given: dict[str, object], kind: str) -> list[str]:
    """Names of the items of a kind, as the page gets them."""
    items = given["items"]
    assert isinstance(items, list)
    return [item["name"] for item in items if item["kind"] == kind]


@pytest.mark.parametrize(("name", "language"), EVERY)
def test_every_instrument_speaks_every_language(name: str, language: str) -> None:
    given = rendered(load_instrument(name, language), seed=1)
    assert json.loads(json.dumps(given)) == given
    assert given["language"] == language
    assert set(languages()) == {"de", "en", "ja"}


def test_english_wording_is_that_of_the_publications() -> None:
    tlx = load_instrument("nasa-tlx", "en").texts
    assert tlx["performance"].text == (
        "How successful were you in accomplishing what you were asked to do?"
    )
    assert (tlx["performance"].low, tlx["performance"].high) == ("Perfect", "Failure")
    assert (tlx["effort"].low, tlx["effort"].high) == ("Very Low", "Very High")
    assert load_instrument("ssq", "en").texts["nausea"].labels == {
        "0": "None",
        "1": "Slight",
        "2": "Moderate",
        "3": "Severe",
    }
    trust = load_instrument("trust", "en")
    assert trust.texts["security"].text == "The system provides security"


def test_the_tlx_has_21_ticks_and_turns_nothing_round() -> None:
    scales = [i for i in load_definition("nasa-tlx").items if i.kind == "scale"]
    assert [(s.high - s.low) / s.step + 1 for s in scales] == [21.0] * 6
    assert not any(scale.reversed for scale in scales)


def test_languages_have_the_same_words_with_the_same_places() -> None:
    english = load_texts("en").pages
    for language in languages():
        pages = load_texts(language).pages
        places = {key: set(PLACE.findall(text)) for key, text in pages.items()}
        assert places == {k: set(PLACE.findall(text)) for k, text in english.items()}


@pytest.mark.parametrize("language", ["de", "ja"])
def test_no_translation_claims_to_be_validated(language: str) -> None:
    wording = yaml.safe_load(
        (own_folder("texts") / f"{language}.yaml").read_text("utf-8")
    )["wording"]
    for name in ("nasa-tlx", "ssq", "fms", "acceptance", "trust"):
        assert wording[name] == "translation of costeer's own, not validated"


def test_every_code_of_a_problem_has_words() -> None:
    assert {f"error_{code}" for code in Code.__args__} <= set(load_texts("en").pages)


def test_comparisons_are_all_fifteen_in_an_order_of_the_seed() -> None:
    instrument = load_instrument("nasa-tlx", "en")
    first, again, other = (rendered(instrument, seed) for seed in (1, 1, 2))
    assert first == again
    assert sorted(names(first, "pairs")) == sorted(names(other, "pairs"))
    assert names(first, "pairs") != names(other, "pairs")
    assert len(set(names(first, "pairs"))) == 15
    assert first["step"] != other["step"]


def test_each_scale_stands_on_either_side_about_as_often() -> None:
    instrument = load_instrument("nasa-tlx", "en")
    turned = 0
    for seed in range(100):
        for item in rendered(instrument, seed)["items"]:
            if item["kind"] == "pairs":
                values = [option["value"] for option in item["options"]]
                turned += "_or_".join(values) != item["name"]
    # 1500 fair coins: five standard deviations of 19.4
    assert abs(turned - 750) < 97


def test_order_and_sides_are_the_same_on_every_machine() -> None:
    items = rendered(load_instrument("nasa-tlx", "en"), seed=7)["items"]
    digest = [
        "+".join(option["value"] for option in item["options"])
        for item in items
        if item["kind"] == "pairs"
    ]
    # By `printf "7 order NAME" | sha256sum` of all names, sorted, and the same of
    # "7 side NAME", turned round if the first digit is below 8.
    assert digest[:3] == [
        "frustration+physical_demand",
        "frustration+performance",
        "temporal_demand+performance",
    ]


def test_a_lab_changes_single_words(tmp_path: Path) -> None:
    words = {"instruments": {"fms": {"items": {"sickness": {"text": "Sick?"}}}}}
    folder = write(tmp_path, "texts/en.yaml", words)
    item = load_instrument("fms", "en", folder).texts["sickness"]
    assert (item.text, item.high) == ("Sick?", "Frank sickness")
    assert load_instrument("fms", "en").texts["sickness"].text != "Sick?"


def test_a_lab_adds_an_instrument(tmp_path: Path) -> None:
    items = [{"name": "calm", "kind": "scale", "low": 1, "high": 7}]
    write(
        tmp_path,
        "instruments/mood.yaml",
        {"items": items, "scores": {"m": {"mean": ["calm"]}}},
    )
    words = {
        "title": "Mood",
        "items": {"calm": {"text": "Calm?", "low": "No", "high": "Yes"}},
    }
    write(tmp_path, "texts/en.yaml", {"instruments": {"mood": words}})
    assert "mood" in instrument_names(tmp_path)
    assert load_instrument("mood", "en", tmp_path).title == "Mood"
    with pytest.raises(
        ValueError, match=r"lacks words in 'de': calm, calm.low and .high, title"
    ):
        load_instrument("mood", "de", tmp_path)


def test_a_lab_brings_a_language_but_not_half_of_it(tmp_path: Path) -> None:
    folder = write(tmp_path, "texts/nl.yaml", {"pages": {"form_submit": "Verder"}})
    with pytest.raises(ValueError, match=r"words are missing: answer_no, answer_yes"):
        load_texts("nl", folder)


def test_blanks_are_filled_and_those_that_are_not_are_named(tmp_path: Path) -> None:
    blanks = {"institution": "the Lab", "contact": "the office", "ethics": "the board"}
    folder = write(tmp_path, "texts/en.yaml", {"blanks": blanks})
    consent = load_instrument("consent", "en", folder)
    assert "at the Lab." in consent.instruction[0]
    assert unfilled(consent) == ("duration",)


def test_the_hash_of_a_consent_changes_with_any_word(tmp_path: Path) -> None:
    before = text_hash(load_instrument("consent", "en"))
    words = {"instruments": {"consent": {"items": {"voluntary": "I take part."}}}}
    folder = write(tmp_path, "texts/en.yaml", words)
    assert text_hash(load_instrument("consent", "en", folder)) != before
    assert text_hash(load_instrument("consent", "de")) != before
    shown = rendered(load_instrument("consent", "en"), seed=3)
    assert (shown["hash"], len(before)) == (before, 64)


@pytest.mark.parametrize("name", ["../texts/en", "nothing", "", "/etc/passwd"])
def test_an_unknown_instrument_is_refused_with_the_choice(name: str) -> None:
    with pytest.raises(ValueError, match="choose from acceptance, consent"):
        load_definition(name)
    with pytest.raises(ValueError, match="choose from de, en, ja"):
        load_texts(name)


SCALE = {"name": "a", "kind": "scale", "low": 0, "high": 3}


@pytest.mark.parametrize(
    ("said", "told"),
    [
        ({"items": []}, "items: give a list"),
        ({"items": [SCALE], "colour": 1}, "no field 'colour'"),
        ({"items": [SCALE], "name": "other"}, "name is 'other'"),
        ({"items": [SCALE, SCALE]}, "item 'a' is there twice"),
        ({"items": [{"name": "A b", "kind": "text"}]}, "give name, of small letters"),
        ({"items": [{"name": "a", "kind": "slider"}]}, "kind is 'slider'; give scale"),
        ({"items": [{**SCALE, "step": 2}]}, "whole number of steps"),
        ({"items": [{**SCALE, "step": 0}]}, "whole number of steps"),
        ({"items": [{**SCALE, "high": 1000}]}, "at most 200"),
        ({"items": [{**SCALE, "high": "9"}]}, "high is '9'; give a number"),
        ({"items": [{**SCALE, "reversed": "yes"}]}, "give true or false"),
        ({"items": [{**SCALE, "options": ["a"]}]}, "no field 'options'"),
        ({"items": [{"name": "a", "kind": "choice"}]}, "options is None; give a list"),
        ({"items": [{"name": "a", "kind": "pairs", "of": ["b", "b"]}]}, "name twice"),
        ({"items": [{"name": "a", "kind": "text", "longest": 9999}]}, "give 1 to 2000"),
        ({"items": [SCALE], "scores": {"s": {"mean": ["b"]}}}, r"\['b'\] is no scale"),
        ({"items": [SCALE], "scores": {"s": {"mean": [["a"]]}}}, "is no scale"),
        ({"items": [SCALE], "scores": {"s": {"weighted": ["a"]}}}, "no pairs to weigh"),
        ({"items": [{"name": "a", "kind": "choice", "options": [True]}]}, "in quotes"),
        ({"items": [SCALE], "scores": {"s": 1}}, "give one of mean, sum, weighted"),
        ({"items": [SCALE], "scores": [1]}, "scores: give NAME: VALUE lines"),
        ({"items": [SCALE], "stop": {"score": "s", "at_least": 1}}, "'s' is no score"),
        (
            {"items": [SCALE], "scores": {"s": {"sum": ["a"]}}, "stop": {"score": "s"}},
            "give at_least",
        ),
    ],
)
def test_a_wrong_file_is_refused_with_its_place(
    tmp_path: Path, said: object, told: str
) -> None:
    folder = write(tmp_path, "instruments/mine.yaml", said)
    with pytest.raises(ValueError, match=told) as refused:
        load_definition("mine", folder)
    assert "mine.yaml" in str(refused.value)


@pytest.mark.parametrize("content", ["a: [", "just words", "- 1"])
def test_what_is_no_mapping_is_refused(tmp_path: Path, content: str) -> None:
    (tmp_path / "instruments").mkdir()
    (tmp_path / "instruments" / "mine.yaml").write_text(content, "utf-8")
    with pytest.raises(ValueError, match=r"mine.yaml is (not YAML|no list of names)"):
        load_definition("mine", tmp_path)


def test_an_unknown_field_of_texts_is_refused(tmp_path: Path) -> None:
    folder = write(tmp_path, "texts/en.yaml", {"page": {}})
    with pytest.raises(ValueError, match="no field 'page'; choose from blanks"):
        load_texts("en", folder)


@pytest.mark.parametrize(
    ("said", "told"),
    [
        ({"pages": {"form_submit": None}}, "pages: form_submit: give a text"),
        ({"pages": ["a"]}, "pages: give NAME: VALUE lines"),
        ({"instruments": {"fms": "a"}}, "fms: give NAME: VALUE lines"),
        ({"instruments": {"fms": {"items": ["a"]}}}, "fms: items: give NAME: VALUE"),
        ({"instruments": {"fms": {"items": {"sickness": 1}}}}, "fms: sickness: give"),
        ({"instruments": {"fms": {"labels": ["a"]}}}, "fms: labels: give NAME"),
        ({"instruments": {"fms": {"instruction": 1}}}, "give a list of paragraphs"),
    ],
)
def test_a_wrong_text_is_refused_with_its_place(
    tmp_path: Path, said: object, told: str
) -> None:
    folder = write(tmp_path, "texts/en.yaml", said)
    with pytest.raises(ValueError, match=told) as refused:
        load_texts("en", folder)
    assert "en.yaml" in str(refused.value)


def test_a_text_alone_changes_the_question_and_keeps_the_rest(tmp_path: Path) -> None:
    words = {"instruments": {"fms": {"items": {"sickness": "Sick?"}}}}
    folder = write(tmp_path, "texts/en.yaml", words)
    item = load_instrument("fms", "en", folder).texts["sickness"]
    assert (item.text, item.low) == ("Sick?", "No sickness at all")
