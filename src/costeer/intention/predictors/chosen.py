"""The predictor that a trial asks: shipped, with weights of one's own, or one's own.

The network of the paper's form runs compiled within the loop. Every other predictor is
called with the last window of 180 samples, 60 times a second, outside it.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from functools import cache, partial
from pathlib import Path
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from costeer.base.files import read_whole
from costeer.base.plugins import refuse_twin
from costeer.base.registry import Registry
from costeer.base.sources import plain, source_hash
from costeer.intention.checked import passed_band
from costeer.intention.features import NUM_FEATURES, WINDOW_LENGTH
from costeer.intention.gru import NetworkWeights
from costeer.intention.predictors.interface import Predictor
from costeer.intention.predictors.registry import OURS, PREDICTORS, predictor
from costeer.intention.starts import Band
from costeer.intention.weights import load_weights

ENTRY_POINTS = "costeer.predictors"
"""Group of entry points under which an installed package offers its predictors."""

Window: TypeAlias = NDArray[np.float64]
"""The last samples of the six signals, facing right, NaN where missing: shape
`(180, 6)`, in the order of `features.FEATURES`."""

Judge: TypeAlias = Callable[[Window], float]
"""From a window to the probability that the line is crossed soon; NaN: no verdict."""


class ChosenPredictor(NamedTuple):
    """What gives a trial its crossing probability.

    Attributes:
        name: In records and tables.
        hash: Of its numbers or sources.
        weights: Of a network that runs compiled; None for one that is called.
        judge: Called with each window; None for a network.
        band: With which the network has passed the check of its bracketed form.
    """

    name: str
    hash: str
    weights: NetworkWeights | None = None
    judge: Judge | None = None
    band: Band | None = None


def chosen_predictor(
    wanted: str | Predictor | Judge = OURS, weights: str | None = None
) -> ChosenPredictor:
    """The predictor that is meant.

    Args:
        wanted: A name of `PREDICTORS` or of an installed plug-in, `module:object`,
            `file.py`, `file.py:object`, a `Predictor`, or a function of windows.
        weights: File of its numbers: `.npz` of costeer, or `.onnx` of any network that
            takes windows; those that ship with costeer if None.

    Raises:
        ValueError: If there is no such predictor or the file does not fit.
        OSError: If the file cannot be read.
        ModuleNotFoundError: If an ONNX file is given and no runtime is installed.
    """
    if weights is not None and wanted != OURS and not _takes_weights(wanted, weights):
        raise ValueError(
            f"predictor {wanted} and weights {weights} do not go together; leave one "
            "of them out"
        )
    if not isinstance(wanted, str):
        return _own(wanted)
    if weights is not None and weights.endswith(".onnx"):
        return _onnx(Path(weights), _stamp(weights))
    if wanted in PREDICTORS:
        refuse_twin(ENTRY_POINTS, wanted)
        return _shipped(wanted, weights, _stamp(weights))
    return _plugged_in(wanted, weights)


def _takes_weights(wanted: str | Predictor | Judge, weights: str) -> bool:
    """Whether a predictor reads its numbers from such a file."""
    return (
        isinstance(wanted, str)
        and wanted in PREDICTORS
        and not weights.endswith(".onnx")
    )


def _stamp(file: str | None) -> tuple[int, int]:
    """When a file was last written, and its size: one written anew is read anew."""
    if file is None:
        return 0, 0
    about = Path(file).stat()
    return about.st_mtime_ns, about.st_size


@cache
def _shipped(wanted: str, weights: str | None, _: tuple[int, int]) -> ChosenPredictor:
    """A predictor of costeer's own, with the numbers of a file."""
    path = None if weights is None else Path(weights)
    if wanted == OURS:
        network = load_weights(path)
        return ChosenPredictor(
            OURS,
            network.hash,
            weights=network.weights,
            band=passed_band(network),
        )
    found = predictor(wanted, path)
    return ChosenPredictor(wanted, _file_hash(path), judge=_last_of(found))


def _plugged_in(wanted: str, weights: str | None) -> ChosenPredictor:
    """A predictor of an installed plug-in or of a place.

    Raises:
        ValueError: If there is none.
    """
    found = _REGISTRY.loaded(wanted)
    if weights is not None:
        raise ValueError(
            f"predictor {wanted} reads no weights of costeer; leave --weights out"
        )
    return _own(found)


def _file_hash(path: Path | None) -> str:
    """Hash of a file of fitted numbers; of the shipped one its place says enough."""
    if path is None:
        return "shipped"
    return hashlib.sha256(read_whole(path)).hexdigest()


def _last_of(found: Predictor) -> Judge:
    """A predictor of stretches, asked for the end of a window."""

    def judge(window: Window) -> float:
        return float(found.probabilities(window, ())[-1])

    return judge


def _own(wanted: Predictor | Judge) -> ChosenPredictor:
    """What someone has written.

    Raises:
        ValueError: If it cannot be called, or has no sources that a record could name.
    """
    if isinstance(wanted, Predictor):
        hashed = source_hash((wanted.probabilities,))
        return ChosenPredictor(wanted.name, hashed, judge=_last_of(wanted))
    if not callable(wanted):
        raise ValueError(
            f"{wanted!r} is no predictor; give a function of a window of shape "
            f"({WINDOW_LENGTH}, {NUM_FEATURES}) that returns a probability"
        )
    name = getattr(wanted, "__name__", None) or _called(wanted)
    return ChosenPredictor(name, source_hash((wanted,)), judge=wanted)


_REGISTRY = Registry[Any](
    what="predictor",
    group=ENTRY_POINTS,
    own=dict.fromkeys(PREDICTORS),
    kind=object,
    checked=_own,
)


def _called(wanted: Judge) -> str:
    """Name of what has none itself: of its class, or of what a partial calls."""
    kind = type(wanted)
    return plain(wanted)[0].__name__ if kind is partial else kind.__name__


@cache
def _onnx(path: Path, _: tuple[int, int]) -> ChosenPredictor:
    """A network in an ONNX file, run by ONNX Runtime on one thread.

    Raises:
        ValueError: If it does not take windows of the six signals.
    """
    content = read_whole(path)
    try:
        import onnxruntime
    except ModuleNotFoundError as error:
        raise ModuleNotFoundError(
            f"{path} needs onnxruntime, which is not installed; install it with: pip "
            "install 'costeer[drive]'"
        ) from error
    options = onnxruntime.SessionOptions()
    options.intra_op_num_threads = 1
    try:
        session = onnxruntime.InferenceSession(content, options)
    except Exception as error:  # ONNX Runtime has no class of its own for this
        raise ValueError(f"{path} is no ONNX model: {error}") from error
    _check_onnx(path, session)
    (given,) = session.get_inputs()

    def judge(window: Window) -> float:
        batch = window[None].astype(np.float32)
        said = np.asarray(session.run(None, {given.name: batch})[0]).ravel()
        return float(said[-1])

    return ChosenPredictor(path.stem, hashlib.sha256(content).hexdigest(), judge=judge)


def _check_onnx(path: Path, session: Any) -> None:  # Any: of ONNX Runtime
    """Refuse a model of other inputs or outputs.

    Raises:
        ValueError: Saying what it takes and what it should take.
    """
    inputs, outputs = session.get_inputs(), session.get_outputs()
    wanted = (WINDOW_LENGTH, NUM_FEATURES)
    told = ", ".join(f"{each.name} {each.type} {each.shape}" for each in inputs)
    fits = len(inputs) == 1 and len(inputs[0].shape) == 3
    if fits:
        sizes = tuple(inputs[0].shape[1:])
        fits = all(
            isinstance(s, str | None) or s == w
            for s, w in zip(sizes, wanted, strict=True)
        )
        fits = fits and inputs[0].type == "tensor(float)"
    if not fits or not outputs:
        raise ValueError(
            f"{path} takes {told}; give a model of one input, tensor(float) [batch, "
            f"{wanted[0]}, {wanted[1]}]: the last 3 s of the signals of Eq. (1)"
        )
    try:
        said = session.run(None, {inputs[0].name: np.zeros((1, *wanted), np.float32)})[
            0
        ]
    except Exception as error:  # as above
        raise ValueError(f"{path} cannot be run on a window: {error}") from error
    if np.size(said) != 1:
        raise ValueError(
            f"{path} answers a window with {np.size(said)} numbers; give a model whose "
            "first output is one probability"
        )
