"""Let the pages of the API show what docstrings have under `Example:` as an example.

`mkdocs.yml` names this file; griffe itself knows the section as `Examples:` only.
"""

from __future__ import annotations

from typing import Any

import griffe


class ExampleSections(griffe.Extension):
    """Renames the section in every docstring that is read."""

    def on_object(self, *, obj: griffe.Object, **others: Any) -> None:
        """Rename the section in one docstring."""
        if obj.docstring is not None:
            text = obj.docstring.value
            obj.docstring.value = text.replace("\nExample:\n", "\nExamples:\n")
