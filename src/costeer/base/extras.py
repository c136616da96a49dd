"""Libraries that a plain install lacks, and the extra of costeer that brings each."""

from __future__ import annotations

from typing import NamedTuple


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
    Library("mcap", "drive", ("mcap",), "export to MCAP"),
    Library("protobuf", "drive", ("google", "google.protobuf")),
    Library("python-can", "can", ("can",), "a SENSO-Wheel"),
    Library(
        "pylsl",
        "lsl",
        ("pylsl",),
        "head trackers and recorders over Lab Streaming Layer",
    ),
    Library("highway-env", "bench", ("highway_env", "gymnasium"), _PEER),
    Library("commonroad-vehicle-models", "bench", ("vehiclemodels",), _PEER),
    Library("onnx", "dev", ("onnx",)),
    Library("playwright", "dev", ("playwright",)),
)


def install_command(extra: str) -> str:
    """Command that installs an extra."""
    return f"pip install 'costeer[{extra}]'"
