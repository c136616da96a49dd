"""Intention-based haptic guidance steering: system, simulator, drivers, experiment.

The package follows Yan et al., *Intention-Based Lane Changing and Lane Keeping
Haptic Guidance Steering System*; its docstrings call that "the paper". Each folder
is a room, and a room imports only the rooms before it: `base`, `plant`, `sensing`,
`intention`, `controller`, `methods`, `drivers`, `loop`, `training`, `study`,
`validation`, then `bench`, `doctor` and `cli`.
"""

from importlib.metadata import version

__all__ = ["__version__"]

__version__ = version("costeer")
