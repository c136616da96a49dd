"""An instrument with its words, and as the page shows it."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

from costeer.sessions.questionnaires.definition import (
    Definition,
    Item,
    Score,
    Stop,
    load_definition,
)
from costeer.sessions.questionnaires.texts import (
    BLANK,
    Texts,
    Words,
    filled,
    load_texts,
)


class ItemText(NamedTuple):
    """Words of an item.

    Attributes:
        title: A short name; may be empty.
        text: The question or statement.
        low: Words at the low end of a scale.
        high: Words at its high end.
        labels: Words of a value of a scale or of an option, by value as text.
    """

    title: str
    text: str
    low: str
    high: str
    labels: dict[str, str]


class Instrument(NamedTuple):
    """A questionnaire in a language.

    Attributes:
        name: Its name.
        version: Version of items and scores.
        source: The publication it comes from.
        language: Code of the language.
        title: Heading.
        instruction: Paragraphs above the items.
        items: The questions.
        texts: Words of each item, by its name.
        scores: What is made of the answers.
        stop: When not to go on; None if it says nothing of that.
    """

    name: str
    version: str
    source: str
    language: str
    title: str
    instruction: tuple[str, ...]
    items: tuple[Item, ...]
    texts: dict[str, ItemText]
    scores: tuple[Score, ...]
    stop: Stop | None


def load_instrument(name: str, language: str, folder: Path | None = None) -> Instrument:
    """A questionnaire in a language.

    Args:
        name: Of the instrument.
        language: Code of the language, such as "en".
        folder: The study folder, whose `instruments/` and `texts/` go first.

    Raises:
        ValueError: If there is no such instrument or language, a file is wrong, or
            words are missing; it names them all.
        OSError: If a file cannot be read.
    """
    definition = load_definition(name, folder)
    texts = load_texts(language, folder)
    words = texts.instruments.get(definition.texts, {})
    missing = _missing(definition, words, texts)
    if missing:
        raise ValueError(
            f"instrument {name!r} lacks words in {language!r}: {', '.join(missing)}; "
            f"write them into texts/{language}.yaml of the study folder, under "
            f"instruments: {definition.texts}"
        )
    instruction = words.get("instruction", [])
    return Instrument(
        name=name,
        version=definition.version,
        source=definition.source,
        language=language,
        title=filled(str(words["title"]), texts.blanks),
        instruction=tuple(
            filled(str(each), texts.blanks)
            for each in ([instruction] if isinstance(instruction, str) else instruction)
        ),
        items=definition.items,
        texts={item.name: _text_of(item, words, texts) for item in definition.items},
        scores=definition.scores,
        stop=definition.stop,
    )


def _said(item: Item, words: Words) -> Words:
    """What the texts say of an item: its own words, else those of the instrument."""
    own = words.get("items", {}).get("pairs" if item.kind == "pairs" else item.name, {})
    usual = {key: words[key] for key in ("low", "high", "labels") if key in words}
    return {**usual, **({"text": own} if isinstance(own, str) else own)}


def _text_of(item: Item, words: Words, texts: Texts) -> ItemText:
    """Words of an item that are all there."""
    said = _said(item, words)
    labels = {str(k): str(v) for k, v in said.get("labels", {}).items()}
    if item.kind == "yes_no":
        pages = texts.pages
        labels = {"yes": pages["answer_yes"], "no": pages["answer_no"], **labels}
    if item.kind == "pairs":
        titles = words.get("items", {})
        labels = {name: str(titles[name]["title"]) for name in item.options}
    return ItemText(
        title=filled(str(said.get("title", "")), texts.blanks),
        text=filled(str(said.get("text", "")), texts.blanks),
        low=str(said.get("low", "")),
        high=str(said.get("high", "")),
        labels=labels if item.kind not in ("number", "text") else {},
    )


def _missing(definition: Definition, words: Words, texts: Texts) -> list[str]:
    """Where words are missing."""
    missing = [] if "title" in words else ["title"]
    own = words.get("items", {})
    for item in definition.items:
        if item.kind == "pairs":
            missing += [
                f"{name}.title"
                for name in item.options
                if "title" not in own.get(name, {})
            ]
            continue
        text = _text_of(item, words, texts)
        if not text.text and not text.title and not (text.low and text.high):
            missing.append(item.name)
        if item.kind == "scale" and not text.labels and not (text.low and text.high):
            missing.append(f"{item.name}.low and .high")
        missing += [
            f"{item.name}.labels.{option}"
            for option in item.options
            if option not in text.labels
        ]
    return sorted(set(missing))


def rendered(instrument: Instrument, seed: int) -> dict[str, Any]:
    """What the page is given to show, ready for JSON.

    Pairs come after all else, in an order and with sides that only the seed decides,
    on every machine alike.

    Args:
        instrument: What is shown.
        seed: Another one for each participant and step. It also names the draft that
            the page keeps until the answers are sent.
    """
    plain = [item for item in instrument.items if item.kind != "pairs"]
    pairs = [item for item in instrument.items if item.kind == "pairs"]
    pairs.sort(key=lambda item: _chance(seed, "order", item.name))
    return {  # Any: strings, numbers, lists and mappings, as JSON has them
        "name": instrument.name,
        "version": instrument.version,
        "language": instrument.language,
        "step": f"{instrument.name}-{seed}",
        "hash": text_hash(instrument),
        "title": instrument.title,
        "instruction": list(instrument.instruction),
        "items": [_shown(instrument, item, seed) for item in (*plain, *pairs)],
    }


def _shown(instrument: Instrument, item: Item, seed: int) -> dict[str, Any]:
    """One item for the page; Any as in `rendered`."""
    text = instrument.texts[item.name]
    shown: dict[str, Any] = {
        "name": item.name,
        "kind": item.kind,
        "required": item.required,
        "title": text.title,
        "text": text.text,
    }
    if item.kind in ("scale", "number"):
        shown |= {"low": item.low, "high": item.high, "step": item.step}
    if item.kind == "scale":
        shown |= {"low_text": text.low, "high_text": text.high, "labels": text.labels}
    if item.kind == "text":
        shown |= {"longest": item.longest}
    if item.kind == "yes_no":
        shown |= {"must_agree": item.must_agree}
    options = item.options
    if item.kind == "pairs" and _chance(seed, "side", item.name) < "8":
        options = options[::-1]
    if options:
        shown["options"] = [
            {"value": value, "label": text.labels[value]} for value in options
        ]
    return shown


def _chance(seed: int, use: str, name: str) -> str:
    """Hexadecimal digits that a seed, a use and a name decide."""
    return hashlib.sha256(f"{seed} {use} {name}".encode()).hexdigest()


def text_hash(instrument: Instrument) -> str:
    """SHA-256 of every word that a participant is shown, and of the version.

    It is kept with a consent, so that it can be told to what someone agreed.
    """
    texts: Mapping[str, ItemText] = instrument.texts
    shown = [
        instrument.name,
        instrument.version,
        instrument.language,
        instrument.title,
        list(instrument.instruction),
        [[item.name, *texts[item.name]] for item in instrument.items],
    ]
    words = json.dumps(shown, ensure_ascii=False, sort_keys=True)
    return hashlib.sha256(words.encode()).hexdigest()


def unfilled(instrument: Instrument) -> tuple[str, ...]:
    """Blanks such as `[[contact]]` that the study has not filled, by name."""
    texts = [f"{text.title} {text.text}" for text in instrument.texts.values()]
    everything = " ".join([instrument.title, *instrument.instruction, *texts])
    return tuple(sorted(set(BLANK.findall(everything))))
