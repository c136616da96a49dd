"""What an instrument asks and how it is scored, as its YAML file says."""

from __future__ import annotations

import itertools
import math
import re
from collections.abc import Mapping, Sequence
from functools import cache, lru_cache
from importlib.resources import files
from pathlib import Path
from typing import Any, Literal, NamedTuple, get_args

from costeer.base import nested

Kind = Literal["scale", "choice", "number", "text", "pairs", "yes_no"]
How = Literal["mean", "sum", "weighted"]

LONGEST_TEXT = 2000
"""Most characters of a free answer."""

MOST_STEPS = 200
"""Most positions of a scale."""

_NAME = re.compile(r"[a-z][a-z0-9_-]*")
_FIELDS = {"name", "version", "source", "texts", "items", "scores", "stop"}
_ITEM_FIELDS = {
    "scale": {"low", "high", "step", "reversed"},
    "number": {"low", "high", "step"},
    "choice": {"options"},
    "text": {"longest"},
    "pairs": {"of"},
    "yes_no": {"must_agree"},
}


class Item(NamedTuple):
    """One question.

    Attributes:
        name: Its name among the answers.
        kind: How it is answered. Each comparison of `pairs` is an item of its own.
        low: Smallest value of a scale or number.
        high: Largest value.
        step: Values lie this far apart, from `low` on.
        reversed: Whether scores use `low + high - value`.
        required: Whether it must be answered.
        options: Values of a choice, of yes or no, or the two that are compared.
        must_agree: Whether only "yes" lets the participant go on.
        longest: Most characters of a text.
    """

    name: str
    kind: Kind
    low: float = math.nan
    high: float = math.nan
    step: float = math.nan
    reversed: bool = False
    required: bool = True
    options: tuple[str, ...] = ()
    must_agree: bool = False
    longest: int = LONGEST_TEXT


class Score(NamedTuple):
    """A number made of answers.

    Attributes:
        name: Its name.
        how: The mean, the sum, or the mean weighted by comparisons won.
        items: Names of the items; one may be counted several times.
        factor: The result is multiplied by it.
    """

    name: str
    how: How
    items: tuple[str, ...]
    factor: float = 1.0


class Stop(NamedTuple):
    """When a participant should not go on.

    Attributes:
        score: Name of the score that decides.
        at_least: From this value on.
        from_baseline: Whether its rise over the first answers counts, not its value.
    """

    score: str
    at_least: float
    from_baseline: bool = False


class Definition(NamedTuple):
    """An instrument without its words.

    Attributes:
        name: Name of the instrument and of its file.
        version: Changes whenever an item or a score does.
        source: The publication it comes from.
        texts: Name under which the texts have its words; often `name`.
        items: The questions, pairs written out.
        scores: What is made of the answers.
        stop: When not to go on; None if it says nothing of that.
    """

    name: str
    version: str
    source: str
    texts: str
    items: tuple[Item, ...]
    scores: tuple[Score, ...]
    stop: Stop | None


def instrument_names(folder: Path | None = None) -> tuple[str, ...]:
    """Names of all instruments, those of the study folder among them."""
    places = [own_folder("instruments"), *([folder / "instruments"] if folder else [])]
    return tuple(sorted({f.stem for place in places for f in place.glob("*.yaml")}))


@cache
def own_folder(name: str) -> Path:
    """The folder of instruments or texts that costeer brings."""
    return Path(str(files("costeer.sessions.questionnaires"))) / name


def load_definition(name: str, folder: Path | None = None) -> Definition:
    """An instrument without its words; that of the study folder goes first.

    Args:
        name: Of the instrument, which is that of its file without `.yaml`.
        folder: The study folder, which may have `instruments/NAME.yaml`.

    Raises:
        ValueError: If there is none of that name, or its file is wrong.
        OSError: If it cannot be read.
    """
    if name not in instrument_names(folder):
        raise ValueError(
            f"there is no instrument {name!r}; choose from "
            f"{', '.join(instrument_names(folder))}, or write instruments/{name}.yaml "
            "in the study folder"
        )
    path = own_folder("instruments") / f"{name}.yaml"
    if folder is not None and (folder / "instruments" / f"{name}.yaml").is_file():
        path = folder / "instruments" / f"{name}.yaml"
    said = read_mapping(path)
    try:
        return _definition(name, said)
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from None


def read_mapping(path: Path) -> dict[str, Any]:  # Any: as YAML gives it back
    """The fields of a YAML file.

    Raises:
        ValueError: If it is no YAML, or not `name: value` lines.
        OSError: If it cannot be read.
    """
    return dict(_read_mapping(path, path.stat().st_mtime_ns))


@lru_cache(maxsize=64)  # pages ask for the words twice a second
def _read_mapping(path: Path, changed: int) -> dict[str, Any]:
    """As `read_mapping`, of a file that was changed at that time [ns]."""
    return nested.read_mapping(path)


Said = Mapping[str, Any]  # Any: a field as YAML gives it back


def _definition(name: str, said: Said) -> Definition:
    """The instrument that a file describes."""
    _refuse_unknown("the file", said, _FIELDS)
    if said.get("name", name) != name:
        raise ValueError(f"name is {said['name']!r}; give that of the file, {name!r}")
    entries = said.get("items")
    if not isinstance(entries, list) or not entries:
        raise ValueError("items: give a list of at least one item")
    items = tuple(itertools.chain(*(_items(entry) for entry in entries)))
    names = [item.name for item in items]
    if len(set(names)) < len(names):
        twice = next(n for n in names if names.count(n) > 1)
        raise ValueError(f"item {twice!r} is there twice; names differ")
    scores = tuple(_score(n, s, items) for n, s in _mapping(said, "scores").items())
    return Definition(
        name=name,
        version=str(said.get("version", "1")),
        source=" ".join(str(said.get("source", "")).split()),
        texts=str(said.get("texts", name)),
        items=items,
        scores=scores,
        stop=_stop(_mapping(said, "stop"), scores),
    )


def _items(entry: object) -> list[Item]:
    """The items of one entry: one, or one for each pair that is compared."""
    if not isinstance(entry, dict) or not _NAME.fullmatch(str(entry.get("name", ""))):
        raise ValueError(f"item {entry!r}: give name, of small letters, and kind")
    name, said = str(entry["name"]), entry.get("kind")
    where = f"item {name!r}"
    kind: Kind | None = next((known for known in get_args(Kind) if known == said), None)
    if kind is None:
        raise ValueError(f"{where}: kind is {said!r}; give {', '.join(get_args(Kind))}")
    _refuse_unknown(where, entry, {"name", "kind", "required"} | _ITEM_FIELDS[kind])
    required = _flag(where, entry, "required", True)
    if kind == "pairs":
        return [
            Item(f"{a}_or_{b}", "pairs", required=required, options=(a, b))
            for a, b in itertools.combinations(_names(where, entry, "of"), 2)
        ]
    item = Item(name, kind, required=required)
    if kind in ("scale", "number"):
        return [_ranged(where, item, entry)]
    if kind == "choice":
        return [item._replace(options=_names(where, entry, "options"))]
    if kind == "yes_no":
        agree = _flag(where, entry, "must_agree", False)
        return [item._replace(options=("yes", "no"), must_agree=agree)]
    longest = int(_number(where, entry, "longest", LONGEST_TEXT))
    if not 1 <= longest <= LONGEST_TEXT:
        raise ValueError(f"{where}: longest is {longest}; give 1 to {LONGEST_TEXT}")
    return [item._replace(longest=longest)]


def _ranged(where: str, item: Item, entry: Said) -> Item:
    """A scale or number with its range."""
    low, high = (_number(where, entry, side, math.nan) for side in ("low", "high"))
    step = _number(where, entry, "step", 1.0)
    steps = (high - low) / step if step > 0.0 else math.nan
    whole = math.isfinite(steps) and abs(steps - round(steps)) < 1e-9
    if not whole or steps < 1 or (item.kind == "scale" and steps > MOST_STEPS):
        raise ValueError(
            f"{where}: low {low:g}, high {high:g}, step {step:g}; give numbers with a "
            f"whole number of steps between them, for a scale at most {MOST_STEPS}"
        )
    turned = _flag(where, entry, "reversed", False)
    return item._replace(low=low, high=high, step=step, reversed=turned)


def _score(name: str, entry: object, items: Sequence[Item]) -> Score:
    """A score whose items exist."""
    where = f"score {name!r}"
    hows = [how for how in get_args(How) if isinstance(entry, dict) and how in entry]
    if not isinstance(entry, dict) or len(hows) != 1:
        raise ValueError(f"{where}: give one of {', '.join(get_args(How))}")
    _refuse_unknown(where, entry, {*get_args(How), "factor"})
    of = entry[hows[0]]
    known = {item.name for item in items if item.kind in ("scale", "number")}
    names = of if isinstance(of, list) else [of]
    missing = [n for n in names if not isinstance(n, str) or n not in known]
    if missing or not of:
        raise ValueError(f"{where}: {missing} is no scale or number of this instrument")
    if hows[0] == "weighted" and all(item.kind != "pairs" for item in items):
        raise ValueError(
            f"{where}: there are no pairs to weigh by; give an item of them"
        )
    factor = _number(where, entry, "factor", 1.0)
    return Score(name, hows[0], tuple(map(str, of)), factor)


def _stop(entry: Said, scores: Sequence[Score]) -> Stop | None:
    """The rule to stop, if there is one."""
    if not entry:
        return None
    _refuse_unknown("stop", entry, set(Stop._fields))
    score = str(entry.get("score"))
    if score not in {s.name for s in scores}:
        raise ValueError(f"stop: {score!r} is no score of this instrument")
    limit = _number("stop", entry, "at_least", math.nan)
    if not math.isfinite(limit):
        raise ValueError("stop: give at_least, the score to stop from")
    return Stop(score, limit, _flag("stop", entry, "from_baseline", False))


def _refuse_unknown(where: str, said: Said, known: set[str]) -> None:
    unknown = sorted(str(name) for name in said if name not in known)
    if unknown:
        raise ValueError(
            f"{where}: there is no field {unknown[0]!r}; choose from "
            f"{', '.join(sorted(known))}"
        )


def _mapping(said: Said, name: str) -> dict[str, Any]:  # Any: as YAML gives it back
    value = said.get(name) or {}
    if not isinstance(value, dict):
        raise ValueError(f"{name}: give NAME: VALUE lines")
    return {str(key): each for key, each in value.items()}


def _names(where: str, entry: Said, field: str) -> tuple[str, ...]:
    value = entry.get(field)
    names = value if isinstance(value, list) else []
    if len(names) < 2 or not all(isinstance(n, str) for n in names):
        raise ValueError(
            f"{where}: {field} is {value!r}; give a list of two or more texts, yes and "
            "no in quotes"
        )
    if len(set(names)) < len(names):
        raise ValueError(f"{where}: {field} has a name twice: {', '.join(names)}")
    return tuple(names)


def _flag(where: str, entry: Said, field: str, usual: bool) -> bool:
    value = entry.get(field, usual)
    if not isinstance(value, bool):
        raise ValueError(f"{where}: {field} is {value!r}; give true or false")
    return value


def _number(where: str, entry: Said, field: str, usual: float) -> float:
    value = entry.get(field, usual)
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise ValueError(f"{where}: {field} is {value!r}; give a number")
    return float(value)
