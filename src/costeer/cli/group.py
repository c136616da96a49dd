"""A group of commands that imports a command only when it is called."""

from __future__ import annotations

import re
from importlib import import_module
from importlib.util import find_spec
from typing import Any, ClassVar

import typer
from typer.core import TyperCommand, TyperGroup


class LazyGroup(TyperGroup):
    """Commands known by name and one line until one of them is called.

    Attributes:
        summaries: A line of help for each command; the first of its docstring.
        package: Where the modules of the commands are; a command bears the name of
            its module. One without a module is not listed.
    """

    summaries: ClassVar[dict[str, str]] = {}
    package: ClassVar[str] = ""

    def __init__(self, **settings: Any) -> None:  # Any: handed on to Typer as it is
        super().__init__(**settings)
        self.help = keep_example_lines(self.help or "")
        for name, summary in self.summaries.items():
            if find_spec(f"{self.package}.{name}") is not None:
                self.commands[name] = TyperCommand(
                    name, help=summary, rich_markup_mode=None
                )

    def resolve_command(self, ctx: Any, args: list[str]) -> Any:  # Any: Typer's own
        """Find the command that the words name, and import it."""
        name, command, rest = super().resolve_command(ctx, args)
        if name in self.summaries:
            command = load_command(self.package, name)
        return name, command, rest


def load_command(package: str, name: str) -> TyperCommand:
    """Import a command's module and build the command from its function."""
    function = getattr(import_module(f"{package}.{name}"), name)
    single = typer.Typer(rich_markup_mode=None, add_completion=False)
    single.command(name=name)(function)
    command = typer.main.get_command(single)
    if not isinstance(command, TyperCommand):
        raise TypeError(f"{package}.{name} must hold one function named {name}")
    command.help = keep_example_lines(command.help or "")
    return command


def keep_example_lines(text: str) -> str:
    r"""Mark the example that ends a help text, so that its lines are not joined.

    Typer reads the character \b alone on a line as "leave this paragraph as it is".
    """
    return re.sub(r"\n\n(Examples?:\n)", "\n\n\b\n\\1", text)
