"""What is chosen by name: costeer's own, those of installed packages, and files."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, Generic, NamedTuple, TypeVar, cast

from costeer.base.described import nearest
from costeer.base.plugins import advertised, is_place, load_object, refuse_twin

P = TypeVar("P")


class Registry(NamedTuple, Generic[P]):
    """Things of one kind, which a user may add to.

    Attributes:
        what: One of them is called, in messages; in capitals, the name of the one that
            a file makes.
        group: Of entry points under which an installed package offers its own.
        own: By name, what needs no place to be found.
        kind: Class of what a place holds; `object` for whatever is there.
        checked: Gives back what can be run, and refuses the rest.
    """

    what: str
    group: str
    own: Mapping[str, P]
    kind: type
    checked: Callable[[Any], P]

    def named(self, wanted: str | P) -> P:
        """The one that is meant, if it can be run.

        Args:
            wanted: A name of `own` or of an installed plug-in, `module:object`,
                `file.py`, `file.py:object`, or the thing itself.

        Raises:
            ValueError: If there is none, two have the name, or it cannot be run.
        """
        if isinstance(wanted, str) and wanted in self.own:
            refuse_twin(self.group, wanted)
            return self.checked(self.own[wanted])
        found = self.loaded(wanted) if isinstance(wanted, str) else wanted
        checked: Any = self.checked(found)  # Any: has a name, whatever it is
        if self.own.get(checked.name, checked) != checked:
            raise ValueError(
                f"two {self.what}s are called '{checked.name}'; give yours another name"
            )
        return cast("P", checked)

    def loaded(self, wanted: str) -> Any:
        """What somebody else made, of an installed plug-in or of a place.

        Raises:
            ValueError: If there is none.
        """
        offered = advertised(self.group)
        place = wanted if is_place(wanted) else offered.get(wanted)
        if place is None:
            known = [*self.own, *offered]
            raise ValueError(
                f"{self.what} '{wanted}' is not known{nearest(wanted, known)}; choose "
                f"one of {', '.join(known)}, or give yours as module:object or as a "
                "Python file"
            )
        return load_object(place, self.kind, self.what.upper())
