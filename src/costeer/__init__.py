"""Intention-based haptic guidance steering: system, simulator, drivers, experiment.

The package follows Yan et al., *Intention-Based Lane Changing and Lane Keeping
Haptic Guidance Steering System*; its docstrings call that "the paper". Each folder
is a room, and a room imports only those below it in the list of layers in
pyproject.toml (docs/decisions/0001-layout.md).
"""

from importlib.metadata import version

from costeer import moved

moved.install()

__all__ = ["__version__"]

__version__ = version("costeer")
