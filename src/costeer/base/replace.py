"""Named tuples in code that Numba compiles, as in Python.

`record._replace(field=value)` changes one by naming what is new. Copying the other
fields by hand would forget the one that is added next year, and no type checker would
notice. `Record(field=value)` leaves to the others what the class says.
"""

from __future__ import annotations

from typing import Any, TypeVar, cast

from numba import types as numba_types
from numba.core import errors, imputils, utils
from numba.core.typing import collections, templates, typeof
from numba.core.typing.templates import (
    AbstractTemplate,
    AttributeTemplate,
    infer_getattr,
)
from numba.extending import overload

from costeer.base import lanes

Record = TypeVar("Record")

# Any, here and below: Numba types neither its types nor its decorators.
types: Any = numba_types
_lowers: Any = imputils.lower_builtin
_templates: Any = templates
_typeof: Any = typeof.typeof
_namedtuple_class: Any = collections.NamedTupleClassAttribute

_KEY = (types.BaseNamedTuple, "_replace")


def _replaced(record: Record, **changes: Any) -> Record:
    """The record with some fields changed; what compiled code runs instead."""
    return record._replace(**changes)  # type: ignore[attr-defined,no-any-return]  # any named tuple


@overload(_replaced, strict=False)
def _replaced_compiled(record: Any, **changes: Any) -> Any:
    kind = record.instance_class
    parts = [
        _converted(f"{kind.__name__}.{field}", field, old, changes[field])
        if field in changes
        else f"record.{field}"
        for field, old in zip(record.fields, record.types, strict=True)
    ]
    # Every field is an argument, given or not: Numba keeps machine code by the types
    # of all arguments, so that `x=1.0` and `y=1.0` are not taken for each other.
    arguments = ", ".join(f"{field}=None" for field in record.fields)
    made = f"Tuple({', '.join(parts)})"
    source = f"def implementation(record, {arguments}):\n    return {made}"
    names: dict[str, Any] = {"Tuple": kind}
    exec(source, names)  # no other way to write out the fields of a tuple
    return names["implementation"]


def _converted(place: str, field: str, old: Any, new: Any) -> str:
    """The source that makes the new value one of the field's type.

    Raises:
        TypingError: If the new value is of another kind.
    """
    given = _plain_type(new)
    if given == old or (
        isinstance(old, types.Float) and isinstance(given, types.Float)
    ):
        return field
    if lanes.in_lanes(old, given) and lanes.spread_type(old) == lanes.spread_type(
        given
    ):
        return field
    if isinstance(old, types.Float) and isinstance(
        given, types.Integer | types.Boolean
    ):
        return f"float({field})"
    raise errors.TypingError(f"{place} is {old} and cannot become {given}")


def _plain_type(kind: Any) -> Any:
    """The type of a value that may be a literal."""
    if isinstance(kind, types.Omitted):
        return types.unliteral(types.literal(kind.value))
    return types.unliteral(kind)


@infer_getattr
class _ReplaceMethod(AttributeTemplate):
    """Types `record._replace`."""

    key = types.BaseNamedTuple

    def resolve__replace(self, record: Any) -> Any:
        context = self.context

        class Call(AbstractTemplate):
            key = _KEY

            def generic(self, args: Any, kws: Any) -> Any:
                _check_call(record, args, kws)
                function = context.resolve_value_type(_replaced)
                return function.get_call_type(context, (record,), kws).as_method()

        return types.BoundFunction(Call, record)


def _check_call(record: Any, args: Any, kws: Any) -> None:
    """Refuse a call that Python would refuse.

    Raises:
        TypingError: If a value has no name, or a name is no field.
    """
    name = record.instance_class.__name__
    if args:
        raise errors.TypingError(f"{name}._replace takes values by name only")
    unknown = [field for field in kws if field not in record.fields]
    if unknown:
        raise errors.TypingError(
            f"{name} has no field {', '.join(unknown)}; it has "
            f"{', '.join(record.fields)}"
        )


@_lowers(_KEY, types.BaseNamedTuple, types.VarArg(types.Any))  # type: ignore[untyped-decorator]  # Numba has no types
def _lower_replace(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
    function = context.typing_context.resolve_value_type(_replaced)
    call = context.get_function(function, signature)
    context.add_linking_libs(getattr(call, "libs", ()))
    return call(builder, arguments)


def _made(kind: Any, args: Any, kws: Any) -> Any:
    """The signature of making a named tuple, defaults standing in for what is left out.

    Raises:
        TypingError: If a field without a default is left out, or a name is no field.
    """
    fields = cast("Any", utils).pysignature(kind)
    given = _templates.fold_arguments(
        fields,
        args,
        kws,
        lambda index, field, value: types.unliteral(value),
        lambda index, field, default: _typeof(default),
        None,
    )
    made = types.BaseTuple.from_types(given, kind)
    return _templates.signature(made, *given).replace(pysig=fields)


_usual_call = _namedtuple_class.resolve___call__


def _resolve_call(attribute: Any, made: Any) -> Any:
    """Types `Record(...)`; Numba itself does so only if no field is left out."""
    (whole,) = _usual_call(attribute, made).templates

    class Partial(AbstractTemplate):
        key = whole.key

        def generic(self, args: Any, kws: Any) -> Any:
            is_whole = len(args) + len(kws) == len(made.instance_class._fields)
            return None if is_whole else _made(made.instance_class, args, kws)

    return types.Function((Partial, whole))


# Without it the fields that are left out would be missing, and no error would say so.
_namedtuple_class.resolve___call__ = _resolve_call
