"""Libraries that a plain install lacks, and the extra of costeer that brings each."""

from __future__ import annotations

import json
import shlex
import shutil
import sys
from importlib.metadata import PackageNotFoundError, distribution
from importlib.util import find_spec
from pathlib import Path
from typing import NamedTuple
from urllib.parse import urlsplit
from urllib.request import url2pathname


class Library(NamedTuple):
    """A library of an extra.

    Attributes:
        package: Its name on PyPI.
        extra: Of costeer, which brings it.
        modules: That are imported of it.
        purpose: What it is for; empty if a user's command never needs it.
    """

    package: str
    extra: str
    modules: tuple[str, ...]
    purpose: str = ""


_HEAD = "following the head with a webcam"
_PEER = "a peer in the benchmark"

LIBRARIES = (
    Library("jax", "jax", ("jax",), "gradients and GPUs"),
    Library("optax", "train", ("optax",), "training the intention network"),
    Library("onnxruntime", "drive", ("onnxruntime",), _HEAD),
    Library("opencv-python-headless", "drive", ("cv2",), _HEAD),
    Library("pysdl2", "drive", ("sdl2",), "steering wheels"),
    Library("hidapi", "drive", ("hid",), "Logitech wheels without a driver"),
    Library("playwright", "rehearse", ("playwright",), "rehearsals of a session"),
    Library("mcap", "drive", ("mcap",), "export to MCAP"),
    Library("protobuf", "drive", ("google", "google.protobuf")),
    Library("python-can", "can", ("can",), "a SENSO-Wheel"),
    Library(
        "pylsl",
        "lsl",
        ("pylsl",),
        "head trackers and recorders over Lab Streaming Layer",
    ),
    Library("joblib", "cluster", ("joblib",), "many drivers on a cluster"),
    Library("dask", "cluster", ("dask",), "many drivers on a cluster"),
    Library("distributed", "cluster", ("distributed",), "many drivers on a cluster"),
    Library("salib", "sensitivity", ("SALib",), "`costeer sensitivity`"),
    Library("gymnasium", "gym", ("gymnasium",), "agents that learn to guide or drive"),
    Library("pythonfmu3", "fmu", ("pythonfmu3",), "the guidance as an FMU"),
    Library("highway-env", "bench", ("highway_env",), _PEER),
    Library("commonroad-vehicle-models", "bench", ("vehiclemodels",), _PEER),
    Library("onnx", "dev", ("onnx",)),
    Library("playwright", "dev", ("playwright",)),
)


def install_command(extra: str = "") -> str:
    """Command that installs costeer here once more, with an extra if one is named."""
    source, editable = _source()
    named = f"'{source}[{extra}]'" if extra else shlex.quote(source)
    return f"{pip_command('install')} {'--editable ' if editable else ''}{named}"


def pip_command(verb: str) -> str:
    """`pip install` or another verb, as it works in this environment.

    One that `make` has set up has uv and no pip.
    """
    if find_spec("pip") is not None:
        return f"{_python()} -m pip {verb}"
    if find_spec("uv") is not None:
        return f"{_python()} -m uv pip {verb}"
    if shutil.which("uv") is not None:
        return f"uv pip {verb} --python {shlex.quote(sys.executable)}"
    return f"pip --python {shlex.quote(sys.executable)} {verb}"


def _python() -> str:
    """This interpreter as a shell finds it, by the shortest name."""
    found = shutil.which("python")
    same = found is not None and Path(found).absolute() == Path(sys.executable)
    return "python" if same else shlex.quote(sys.executable)


def _source() -> tuple[str, bool]:
    """Where costeer was installed from: its name or a folder, and whether editable."""
    try:
        told = distribution("costeer").read_text("direct_url.json")
    except PackageNotFoundError:
        told = None
    about = json.loads(told) if told else {}
    place = urlsplit(about.get("url", ""))
    folder = Path(url2pathname(place.path))
    if place.scheme != "file" or not (folder / "pyproject.toml").is_file():
        return "costeer", False
    return str(folder), bool(about.get("dir_info", {}).get("editable"))
