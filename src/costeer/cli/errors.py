"""What a user sees when something is wrong: one line, an exit code, no traceback."""

from __future__ import annotations

import errno
import os
import sys
import traceback
from collections.abc import Callable
from typing import Any

import typer

from costeer.base.extras import LIBRARIES, install_command

BAD_INPUT = 2
INTERRUPTED = 130

_EXTRAS = {name: library.extra for library in LIBRARIES for name in library.modules}
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
        return _refused(error, _usage(error))
    except ModuleNotFoundError as error:
        if error.name is None:  # raised by costeer itself, with the way out
            return _refused(error, str(error))
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
    shown = "".join(letter if letter.isprintable() else "?" for letter in text)
    print(f"costeer: {shown}", file=sys.stderr)
    return BAD_INPUT


def _usage(error: typer.TyperException) -> str:
    """Name the word that was refused, and where the options are listed."""
    # Any: the parser of values is Typer's own affair.
    found: list[Any] = getattr(error.__cause__, "errors", list)()
    kind, value = (found[0]["type"], found[0]["input"]) if found else ("", "")
    if kind in _WANTED:
        option, _, _ = error.format_message().rpartition(": ")
        message = f"{option}: {value!r} is not {_WANTED[kind]}"
    else:
        message = error.format_message().rstrip(".")
    context = getattr(error, "ctx", None)
    if context is None or message.endswith("?"):
        return message
    return f"{message}; see {context.command_path} --help"


_WANTED = {
    "int_parsing": "a whole number",
    "int_parsing_size": "a whole number of a sensible size",
    "float_parsing": "a number, as 12.5",
}
"""What Typer's value parser expected, by the name of its error."""


def _missing_module(name: str) -> str:
    """Say which extra brings a module."""
    return f"{name} is not installed; install it with: {install_command(_EXTRAS[name])}"


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
    errno.EACCES: "; choose a place that is yours, or change its permissions",
    errno.EPERM: "; choose a place that is yours, or change its permissions",
    errno.EROFS: "; choose a place that you may write to",
    errno.EEXIST: "; something of this name is in the way: move it",
    errno.ENOENT: "; check the path",
    errno.EISDIR: "; give a file, not a folder",
    errno.ENOTDIR: "; give a folder, not a file",
}
