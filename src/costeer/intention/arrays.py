"""Files of arrays that say what they are for: how weights are kept.

A NumPy archive (.npz) whose array `header` is JSON: version of the format, the signals
of Eq. (1), the length of the window, a hash of the numbers, and facts of their making.
"""

from __future__ import annotations

import hashlib
import io
import json
import zipfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.base.files import replacing
from costeer.intention.features import FEATURES, WINDOW_LENGTH

Arrays = dict[str, NDArray[Any]]  # Any: of whatever numbers

_LARGEST_SIZE = 1 << 30  # [bytes], a thousand times what costeer ships

FLOATS = ("<f4", "<f8")


class Form(NamedTuple):
    """One kind of such a file.

    Attributes:
        version: Of its format.
        kind: What it holds, in words.
        remedy: What to do about a file of another version or other signals.
    """

    version: int
    kind: str
    remedy: str


def write_arrays(
    path: Path, form: Form, arrays: Mapping[str, NDArray[Any]], **header: object
) -> None:
    """Write a file, whole or not at all.

    Args:
        path: To write or replace.
        form: Kind of the file.
        arrays: By name.
        **header: What else it says of itself, as its hash.
    """
    described = {
        "version": form.version,
        "features": list(FEATURES),
        "window_length": WINDOW_LENGTH,
        **header,
    }
    text = json.dumps(described, sort_keys=True, indent=1).encode()
    named: dict[str, Any] = {"header": np.frombuffer(text, np.uint8), **arrays}
    with replacing(path) as partial, partial.open("wb") as file:
        np.savez(file, **named)


def read_arrays(
    content: bytes, form: Form, source: str
) -> tuple[dict[str, Any], Arrays]:
    """Header and arrays of a file.

    Args:
        content: Of the file.
        form: Kind that it must be of.
        source: Its name, in messages.

    Raises:
        ValueError: If it is of another kind, version or other signals.
    """
    try:
        _refuse_bomb(content)
        with np.load(io.BytesIO(content), allow_pickle=False) as archive:
            arrays = {name: archive[name] for name in archive.files}
        header = dict(json.loads(arrays.pop("header").tobytes()))
    except Exception as error:  # whatever a damaged archive makes numpy raise
        raise ValueError(
            f"{source} is not a file of {form.kind}, or it is damaged; "
            f"restore it, or {form.remedy}"
        ) from error
    if header.get("version") != form.version:
        raise ValueError(
            f"{source} has format version {header.get('version')}, this costeer reads "
            f"version {form.version}: {form.remedy}"
        )
    if header.get("features") != list(FEATURES):
        raise ValueError(
            f"{source} is for the signals {header.get('features')}, not "
            f"{list(FEATURES)}: {form.remedy}"
        )
    return header, arrays


def _refuse_bomb(content: bytes) -> None:
    """Refuse an archive that unpacks to more than any such file holds."""
    with zipfile.ZipFile(io.BytesIO(content)) as archive:
        size = sum(member.file_size for member in archive.infolist())
    if size > _LARGEST_SIZE:
        raise ValueError(f"it unpacks to {size} bytes")


def arrays_hash(arrays: Mapping[str, NDArray[Any]]) -> str:
    """SHA-256 over names, shapes and bytes of all arrays, in the order given."""
    digest = hashlib.sha256()
    for name, values in arrays.items():
        digest.update(f"{name}{values.shape}{values.dtype.str}".encode())
        digest.update(values.tobytes())
    return digest.hexdigest()


def check_array(
    values: NDArray[Any],
    shape: tuple[int, ...],
    place: str,
    types: tuple[str, ...] = FLOATS,
) -> None:
    """Refuse what no fit or training can have given.

    Args:
        values: One array of a file.
        shape: That it must have.
        place: Its name and file, in messages.
        types: That its numbers may have, little-endian.

    Raises:
        ValueError: If shape or type are others, or a value is not finite.
    """
    if values.shape != shape or values.size == 0:
        raise ValueError(f"{place} has the shape {values.shape}, expected {shape}")
    if values.dtype.newbyteorder("<").str not in types:
        raise ValueError(f"{place} holds {values.dtype}, expected one of {types}")
    if not np.isfinite(values).all():
        raise ValueError(f"{place} holds values that are not finite")
    if "_scale of" in place and (values <= 0).any():
        raise ValueError(f"{place} is not positive; standard deviations are")
