"""Eight trials at a time: a number of compiled code that is a vector of eight.

LLVM does not turn a loop over drivers into vector instructions by itself. Where a
number is of this kind, the same equations, compiled for it, do eight trials with each
instruction. Each lane computes what a plain number computes, to the last bit: only
additions, products, quotients, square roots and comparisons, which the standard rounds
in one way (IEEE 754), are done together; sines and the like are made of them
(elementary.py), and what is left goes lane by lane to the C library.

What base/array.py says for other engines is said for this one here.
"""

from __future__ import annotations

import operator
from collections.abc import Callable
from typing import Any

from llvmlite import ir as llvm
from numba import extending
from numba import types as numba_types
from numba.core import imputils, typeconv
from numba.core.datamodel import models as numba_models
from numba.core.typing import templates as numba_templates

# Any, in this file: Numba and LLVM's builder have no types.
types: Any = numba_types
models: Any = numba_models
_conversions: Any = typeconv.Conversion  # type: ignore[attr-defined]  # not exported
templates: Any = numba_templates
ir: Any = llvm
_lowers: Any = imputils.lower_builtin
_casts: Any = imputils.lower_cast
_register: Any = extending.register_model
WIDTH = 8
"""Lanes: one AVX-512 register of doubles; twice as many gain nothing."""

_FLAG, PLACE = ir.IntType(1), ir.IntType(32)


class _Vector(types.Type):  # type: ignore[misc]  # Numba has no types
    """What both kinds share: a plain number or flag becomes one of eight equal ones."""

    plain: tuple[Any, ...] = ()

    def can_convert_from(self, context: Any, other: Any) -> Any:
        """A plain one may stand for eight."""
        return _conversions.safe if isinstance(other, self.plain) else None

    def unify(self, context: Any, other: Any) -> Any:
        """Where two branches meet, a plain one becomes eight."""
        return self if isinstance(other, self.plain) else None


class Lanes(_Vector):
    """A number of each of eight trials."""

    plain = (types.Float, types.Integer)


class Mask(_Vector):
    """A flag of each of eight trials."""

    plain = (types.Boolean,)


NUMBERS, FLAGS = Lanes("Lanes"), Mask("Mask")


@_register(Lanes)
class _LanesModel(models.PrimitiveModel):  # type: ignore[misc]  # as above
    def __init__(self, manager: Any, kind: Any) -> None:
        super().__init__(manager, kind, ir.VectorType(ir.DoubleType(), WIDTH))


@_register(Mask)
class _MaskModel(models.PrimitiveModel):  # type: ignore[misc]  # as above
    def __init__(self, manager: Any, kind: Any) -> None:
        super().__init__(manager, kind, ir.VectorType(_FLAG, WIDTH))


def in_lanes(*kinds: Any) -> bool:
    """Whether a type, or any inside nested tuples of types, is one of eight."""
    return any(
        in_lanes(*kind.types) if isinstance(kind, types.BaseTuple) else is_vector(kind)
        for kind in kinds
    )


def is_vector(kind: Any) -> bool:
    """Whether a type is one of eight."""
    return isinstance(kind, _Vector)


def spread_type(kind: Any) -> Any:
    """The type of a value spread over the lanes; whole numbers and arrays stay."""
    if isinstance(kind, types.BaseTuple):
        inner = [spread_type(each) for each in kind.types]
        return types.BaseTuple.from_types(inner, getattr(kind, "instance_class", None))
    if isinstance(kind, types.Boolean):
        return FLAGS
    return NUMBERS if isinstance(kind, types.Float) else kind


def _equal_lanes(builder: Any, value: Any) -> Any:
    """Eight times the same."""
    vector = ir.VectorType(value.type, WIDTH)
    nowhere = ir.Constant(vector, ir.Undefined)
    first = builder.insert_element(nowhere, value, PLACE(0))
    zeros = ir.Constant(ir.VectorType(PLACE, WIDTH), [0] * WIDTH)
    return builder.shuffle_vector(first, nowhere, zeros)


def _number_to_lanes(context: Any, builder: Any, old: Any, new: Any, value: Any) -> Any:
    number = context.cast(builder, value, types.unliteral(old), types.float64)
    return _equal_lanes(builder, number)


def _flag_to_mask(context: Any, builder: Any, old: Any, new: Any, value: Any) -> Any:
    flag = value if value.type == _FLAG else builder.trunc(value, _FLAG)
    return _equal_lanes(builder, flag)


for _plain in Lanes.plain:
    _casts(_plain, Lanes)(_number_to_lanes)
_casts(types.Boolean, Mask)(_flag_to_mask)


def _shared(args: Any, kind: Any) -> Any:
    """The vector type that all arguments are of, or can become; None for none."""
    found = any(isinstance(each, kind) for each in args)
    fits = all(isinstance(each, (kind, *kind.plain)) for each in args)
    return (NUMBERS if kind is Lanes else FLAGS) if found and fits else None


def _bind(symbol: Any, kind: Any, result: Any, emit: Callable[..., Any]) -> None:
    """Let an operator of Python work on vectors of a kind."""

    def generic(self: Any, args: Any, kws: Any) -> Any:
        shared = _shared(args, kind)
        if shared is None:
            return None
        return templates.signature(result, *[shared] * len(args))

    named = {"generic": generic, "key": symbol}
    template = type("_Vectors", (templates.AbstractTemplate,), named)
    templates.infer_global(symbol)(template)
    operands = [kind] if symbol is operator.neg else [kind, kind]

    def lower(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        return emit(context, builder, signature, args)

    _lowers(symbol, *operands)(lower)


def _instruction(name: str) -> Callable[..., Any]:
    return lambda context, builder, kinds, args: getattr(builder, name)(*args)


def _comparison(sign: str) -> Callable[..., Any]:
    kind = "fcmp_unordered" if sign == "!=" else "fcmp_ordered"
    return lambda context, builder, kinds, args: getattr(builder, kind)(sign, *args)


for _name, _code in {"add": "fadd", "sub": "fsub", "mul": "fmul"}.items():
    _bind(getattr(operator, _name), Lanes, NUMBERS, _instruction(_code))
    _bind(getattr(operator, f"i{_name}"), Lanes, NUMBERS, _instruction(_code))
for _quotient in (operator.truediv, operator.itruediv):
    _bind(_quotient, Lanes, NUMBERS, _instruction("fdiv"))
_bind(operator.neg, Lanes, NUMBERS, _instruction("fneg"))
for _name, _code in {"lt": "<", "le": "<=", "gt": ">", "ge": ">="}.items():
    _bind(getattr(operator, _name), Lanes, FLAGS, _comparison(_code))
_bind(operator.eq, Lanes, FLAGS, _comparison("=="))
_bind(operator.ne, Lanes, FLAGS, _comparison("!="))
for _name, _code in {"and_": "and_", "or_": "or_", "xor": "xor"}.items():
    _bind(getattr(operator, _name), Mask, FLAGS, _instruction(_code))
_bind(operator.ne, Mask, FLAGS, _instruction("xor"))
_bind(operator.eq, Mask, FLAGS, lambda c, b, k, args: b.not_(b.xor(*args)))


def lane_by_lane(function: Callable[..., Any]) -> Callable[..., Any]:
    """What emits a function of numbers, called for each lane by itself."""

    def emit(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        found = ir.Constant(ir.VectorType(ir.DoubleType(), WIDTH), ir.Undefined)
        plain = types.float64(*[types.float64] * len(args))
        for lane in range(WIDTH):
            own = [builder.extract_element(each, PLACE(lane)) for each in args]
            value = context.compile_internal(builder, function, plain, own)
            found = builder.insert_element(found, value, PLACE(lane))
        return found

    return emit


_bind(operator.pow, Lanes, NUMBERS, lane_by_lane(lambda base, power: base**power))
