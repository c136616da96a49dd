"""Named tuples stay whole in code that Numba compiles.

By itself Numba takes a nested tuple apart at every call, number by number, and puts it
together again inside; and it looks through all of its numbers for memory to count
references of. With several hundred numbers in the state of a trial, that is much of
what there is to compile. Here a tuple of costeer's is one value that is handed on as
such. What the code computes does not change by a bit.
"""

from __future__ import annotations

from functools import cached_property
from typing import Any

from numba import types as numba_types
from numba.core.datamodel import models as numba_models
from numba.extending import register_model

# Any, in this file: Numba has no types.
types: Any = numba_types
models: Any = numba_models
_register: Any = register_model
_OURS = __name__.split(".", maxsplit=1)[0]


class _Whole:
    """How a tuple is handed in, handed out and looked into.

    In arrays and constants it lies as before.
    """

    def get_argument_type(self: Any) -> Any:
        """It is handed in as it is."""
        return self.get_value_type()

    def as_argument(self: Any, builder: Any, value: Any) -> Any:
        """Nothing is taken apart."""
        return value

    def from_argument(self: Any, builder: Any, value: Any) -> Any:
        """Nothing is put together."""
        return value

    def get_return_type(self: Any) -> Any:
        """It is handed out as it is."""
        return self.get_value_type()

    def as_return(self: Any, builder: Any, value: Any) -> Any:
        """Nothing is taken apart."""
        return value

    def from_return(self: Any, builder: Any, value: Any) -> Any:
        """Nothing is put together."""
        return value

    @cached_property
    def _counted(self: Any) -> frozenset[Any]:
        """Types of the members that hold memory whose references are counted."""
        kinds = set(self.fe_type.types)
        return frozenset(k for k in kinds if self._dmm[k].contains_nrt_meminfo())

    def traverse(self: Any, builder: Any) -> list[Any]:
        """Types and readers of the members in which references are counted."""
        if not self._counted:
            return []
        members = super().traverse(builder)  # type: ignore[misc]  # of the model beside it
        return [(kind, read) for kind, read in members if kind in self._counted]


class _WholeTuple(_Whole, models.TupleModel):  # type: ignore[misc]  # Numba has no types
    """A named tuple of members of several types."""


class _WholeUniTuple(_Whole, models.UniTupleModel):  # type: ignore[misc]  # as above
    """A named tuple of members of one type."""


def _is_ours(kind: Any) -> bool:
    """Whether a named tuple is costeer's; those of others stay as Numba has them."""
    home: str = kind.instance_class.__module__
    return home.split(".", maxsplit=1)[0] == _OURS


def _tuple_model(manager: Any, kind: Any) -> Any:
    model = _WholeTuple if _is_ours(kind) else models.TupleModel
    return model(manager, kind)


def _uni_tuple_model(manager: Any, kind: Any) -> Any:
    model = _WholeUniTuple if _is_ours(kind) else models.UniTupleModel
    return model(manager, kind)


_register(types.NamedTuple)(_tuple_model)
_register(types.NamedUniTuple)(_uni_tuple_model)
