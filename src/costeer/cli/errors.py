"""What a user sees when something is wrong: one line, an exit code, no traceback."""

from __future__ import annotations

import errno
import os
import sys
import tempfile
import traceback
from collections.abc import Callable
from pathlib import Path
from typing import Any

import typer

from costeer.base.extras import LIBRARIES, install_command

BAD_INPUT = 2
MISTAKE = 70
"""Exit code of a mistake in costeer, as in sysexits.h."""

INTERRUPTED = 130

_EXTRAS = {name: library.extra for library in LIBRARIES for name in library.modules}
"""Extra of costeer that brings each module which a plain install lacks."""


def exit_code_of(run: Callable[[], object]) -> int:
    """Call `run`; turn what it raises into a line on stderr and an exit code.

    Bad input ends with `BAD_INPUT`; whatever else breaks, with `MISTAKE` and a file
    that tells where. With --debug, or COSTEER_TRACEBACK=1, the traceback is shown too.
    """
    try:
        result = run()
    except (KeyboardInterrupt, typer.Abort):
        return _stopped()
    except Exception as error:
        return _ended(error)
    if result == INTERRUPTED:
        return _stopped()
    return result if isinstance(result, int) else 0


def _ended(error: Exception) -> int:
    """Say what a command ended with; return its exit code."""
    if isinstance(error, typer.TyperException):
        return _refused(error, _usage(error))
    if isinstance(error, ModuleNotFoundError):
        if error.name is None:  # raised by costeer itself, with the way out
            return _refused(error, str(error))
        if error.name in _EXTRAS:
            return _refused(error, _missing_module(error.name))
    if isinstance(error, OSError):
        return _refused(error, _system_error(error))
    if isinstance(error, ValueError):
        return _refused(error, str(error))
    if isinstance(error, MemoryError):
        return _refused(error, "there is not enough memory for this; give it less")
    return _mistake(error)


def _stopped() -> int:
    """Say that the user stopped the command."""
    # A KeyboardInterrupt that has passed through `exec`, as in Numba, makes Python end
    # by SIGINT although it was caught; the next `exec` forgets it.
    exec("")
    print("costeer: stopped", file=sys.stderr)
    return INTERRUPTED


def _mistake(error: Exception) -> int:
    """Name what broke, and write where it did into a file that can be sent."""
    what = traceback.format_exception_only(error)[-1].strip()
    words = " ".join(sys.argv[1:])
    told = [f"costeer {words}", sys.version, sys.platform]
    text = "\n".join([*told, *traceback.format_exception(error)])
    try:
        number, name = tempfile.mkstemp(prefix="costeer-error-", suffix=".txt")
        os.close(number)
        Path(name).write_text(text, encoding="utf-8", errors="replace")
        where = f"please send {name}"
    except OSError:
        where = "run it again with --debug and send what it prints"
    _refused(error, f"a mistake in costeer, not in your input: {what}; {where}")
    return MISTAKE


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
