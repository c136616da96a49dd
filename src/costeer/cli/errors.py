"""What a user sees when something is wrong: one line, an exit code, no traceback."""

from __future__ import annotations

import errno
import os
import sys
import traceback
from collections.abc import Callable

import typer

BAD_INPUT = 2
INTERRUPTED = 130

_EXTRAS = {
    "jax": "jax",
    "optax": "train",
    "highway_env": "bench",
    "gymnasium": "bench",
    "vehiclemodels": "bench",
    "onnx": "dev",
    "onnxruntime": "dev",
}
"""Extra of costeer that brings each module which a plain install lacks."""


def exit_code_of(run: Callable[[], object]) -> int:
    """Call `run`; turn what it raises into a line on stderr and an exit code.

    Set COSTEER_TRACEBACK=1 to see where an error came from.
    """
    try:
        result = run()
    except (KeyboardInterrupt, typer.Abort):
        return _stopped()
    except typer.TyperException as error:
        return _refused(error, error.format_message())
    except ModuleNotFoundError as error:
        if error.name not in _EXTRAS:
            raise
        return _refused(error, _missing_module(error.name))
    except OSError as error:
        return _refused(error, _system_error(error))
    except ValueError as error:
        return _refused(error, str(error))
    if result == INTERRUPTED:
        return _stopped()
    return result if isinstance(result, int) else 0


def _stopped() -> int:
    """Say that the user stopped the command."""
    print("costeer: stopped", file=sys.stderr)
    return INTERRUPTED


def _refused(error: Exception, message: str) -> int:
    """Print the message on one line."""
    if os.environ.get("COSTEER_TRACEBACK"):
        traceback.print_exception(error)
    text = " ".join(message.split()) or type(error).__name__
    print(f"costeer: {text}", file=sys.stderr)
    return BAD_INPUT


def _missing_module(name: str) -> str:
    """Say which extra brings a module."""
    extra = _EXTRAS[name]
    return f"{name} is not installed; install it with: pip install 'costeer[{extra}]'"


def _system_error(error: OSError) -> str:
    """Name what could not be done, the file and the way out."""
    number = error.errno or _NUMBERS.get(type(error))
    told = str(error)
    if number is None or (error.errno is None and "; " in told):
        return told
    reason = error.strerror or os.strerror(number)
    place = error.filename or ("" if error.errno else told)
    return f"{place}: {reason}{_REMEDIES.get(number, '')}".removeprefix(": ")


_NUMBERS: dict[type[OSError], int] = {
    FileNotFoundError: errno.ENOENT,
    PermissionError: errno.EACCES,
    IsADirectoryError: errno.EISDIR,
    NotADirectoryError: errno.ENOTDIR,
}
"""What an error without a number means: some libraries give the path alone."""

_REMEDIES = {
    errno.ENOSPC: "; free some space and run the same command again",
    errno.EDQUOT: "; free some space and run the same command again",
    errno.EACCES: "; choose a place that you may write to, or change its permissions",
    errno.EPERM: "; choose a place that you may write to, or change its permissions",
    errno.EROFS: "; choose a place that you may write to",
    errno.ENOENT: "; check the path",
    errno.EISDIR: "; give a file, not a folder",
    errno.ENOTDIR: "; give a folder, not a file",
}
