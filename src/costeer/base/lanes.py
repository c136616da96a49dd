"""What compiled code does with values of eight trials, besides arithmetic.

Choosing lane by lane, spreading a plain value over the lanes, taking one lane out, and
reading and writing arrays whose last axis is the lane. See vectors.py.
"""

from __future__ import annotations

import math
import operator
from collections.abc import Callable
from typing import Any, cast

from llvmlite import ir as llvm
from numba import extending
from numba import types as numba_types
from numba.core import errors

from costeer.base.vectors import (
    FLAGS,
    NUMBERS,
    PLACE,
    WIDTH,
    Lanes,
    Mask,
    in_lanes,
    is_vector,
    lane_by_lane,
    spread_type,
)

__all__ = ["WIDTH", "Mask", "in_lanes", "spread_type"]

# Any, in this file: Numba and LLVM's builder have no types.
types: Any = numba_types
ir: Any = llvm
intrinsic = cast("Callable[[Any], Any]", extending.intrinsic)


def each(function: Callable[[float], float]) -> Any:  # Any: an intrinsic of Numba
    """A function of one number as one of eight."""
    emit = lane_by_lane(lambda x: function(x))

    @intrinsic
    def apply(typing: Any, x: Any) -> Any:
        return NUMBERS(NUMBERS), emit

    return apply


def _of_llvm(name: str) -> Any:  # Any: as above
    """A function that LLVM has for vectors, rounded as the standard says."""

    @intrinsic
    def apply(typing: Any, x: Any) -> Any:
        def emit(context: Any, builder: Any, signature: Any, args: Any) -> Any:
            return _called(builder, name, args[0])

        return NUMBERS(NUMBERS), emit

    return apply


def _called(builder: Any, name: str, value: Any) -> Any:
    whole = f"{name}.v{WIDTH}f64"
    known = builder.module.globals.get(whole)
    kind = ir.FunctionType(value.type, [value.type])
    return builder.call(known or ir.Function(builder.module, kind, whole), [value])


sqrt, floor, absolute = (_of_llvm(f"llvm.{name}") for name in ("sqrt", "floor", "fabs"))


@intrinsic
def isfinite(typing: Any, x: Any) -> Any:
    """Which lanes are neither infinite nor NaN."""

    def emit(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        size = _called(builder, "llvm.fabs", args[0])
        infinite = ir.Constant(args[0].type, [math.inf] * WIDTH)
        return builder.fcmp_ordered("<", size, infinite)

    return FLAGS(NUMBERS), emit


@intrinsic
def logical_not(typing: Any, mask: Any) -> Any:
    """Which lanes are false."""

    def emit(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        return builder.not_(args[0])

    return FLAGS(FLAGS), emit


@intrinsic
def any_lane(typing: Any, mask: Any) -> Any:
    """Whether any lane is true."""

    def emit(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        bits = builder.bitcast(args[0], ir.IntType(WIDTH))
        return builder.icmp_unsigned("!=", bits, ir.IntType(WIDTH)(0))

    return types.boolean(FLAGS), emit


@intrinsic
def all_lanes(typing: Any, mask: Any) -> Any:
    """Whether every lane is true."""

    def emit(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        bits = builder.bitcast(args[0], ir.IntType(WIDTH))
        return builder.icmp_unsigned("==", bits, ir.IntType(WIDTH)(2**WIDTH - 1))

    return types.boolean(FLAGS), emit


@intrinsic
def select(typing: Any, condition: Any, if_true: Any, if_false: Any) -> Any:
    """One of two values for each lane; of tuples, member by member."""
    whole = _joined(if_true, if_false)

    def emit(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        def choose(kind: Any, one: Any, other: Any) -> Any:
            if isinstance(kind, types.BaseTuple):
                inner = [
                    choose(each, *(builder.extract_value(v, k) for v in (one, other)))
                    for k, each in enumerate(kind.types)
                ]
                return context.make_tuple(builder, kind, inner)
            return builder.select(args[0], one, other) if is_vector(kind) else one

        both = zip((if_true, if_false), args[1:], strict=True)
        each = (_spread(context, builder, kind, whole, value) for kind, value in both)
        return _counted(context, builder, whole, choose(whole, *each))

    return whole(condition, if_true, if_false), emit


def choose(condition: bool, if_true: float, if_false: float) -> float:
    """One of two numbers, in compiled code: for each lane, or for a plain number."""
    return if_true if condition else if_false


@extending.overload(choose, strict=False)
def _choose(condition: Any, if_true: Any, if_false: Any) -> Any:
    if isinstance(condition, Mask):
        return lambda condition, if_true, if_false: select(condition, if_true, if_false)
    return lambda condition, if_true, if_false: if_true if condition else if_false


def anywhere(flag: bool) -> bool:
    """Whether a flag is true, in any lane if there are eight."""
    return flag


@extending.overload(anywhere, strict=False)
def _anywhere(flag: Any) -> Any:
    return (lambda flag: any_lane(flag)) if is_vector(flag) else (lambda flag: flag)


@intrinsic
def power_of_two(typing: Any, count: Any) -> Any:
    """2 to a whole number from -1022 to 1023, for each lane or for a plain number.

    Added to 1.5 * 2**52, the number stands in the low bits; moved by 52 places it is
    the exponent of a double.
    """

    def emit(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        number, vector = args[0].type, is_vector(count)
        bits = ir.VectorType(ir.IntType(64), WIDTH) if vector else ir.IntType(64)
        base, places = (
            ir.Constant(kind, [value] * WIDTH if vector else value)
            for kind, value in ((number, 1.5 * 2.0**52 + 1023.0), (bits, 52))
        )
        moved = builder.shl(builder.bitcast(builder.fadd(args[0], base), bits), places)
        return builder.bitcast(moved, number)

    return count(count), emit


def _joined(one: Any, other: Any) -> Any:
    """The type of what is chosen from two, lane by lane.

    Raises:
        TypingError: If they are of two kinds.
    """
    if isinstance(one, types.BaseTuple) and isinstance(other, types.BaseTuple):
        inner = [_joined(*both) for both in zip(one.types, other.types, strict=True)]
        return types.BaseTuple.from_types(inner, getattr(one, "instance_class", None))
    for kind, whole in ((Lanes, NUMBERS), (Mask, FLAGS)):
        if all(isinstance(each, (kind, *kind.plain)) for each in (one, other)):
            return whole
    if one != other:
        raise errors.TypingError(f"{one} and {other} are of two kinds")
    return one


def _counted(context: Any, builder: Any, kind: Any, value: Any) -> Any:
    """A value made of parts that live on elsewhere: one more holds its arrays."""
    context.nrt.incref(builder, kind, value)
    return value


def _spread(context: Any, builder: Any, kind: Any, whole: Any, value: Any) -> Any:
    """A value with what is plain in it made eight, where the whole type has it so."""
    if isinstance(kind, types.BaseTuple):
        inner = [
            _spread(context, builder, old, new, builder.extract_value(value, k))
            for k, (old, new) in enumerate(zip(kind.types, whole.types, strict=True))
        ]
        return context.make_tuple(builder, whole, inner)
    return value if whole == kind else context.cast(builder, value, kind, whole)


@intrinsic
def spread(typing: Any, value: Any) -> Any:
    """The value with every number and flag in it one of eight."""
    whole = spread_type(value)

    def emit(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        made = _spread(context, builder, value, whole, args[0])
        return _counted(context, builder, whole, made)

    return whole(value), emit


def _plain_type(kind: Any) -> Any:
    if isinstance(kind, types.BaseTuple):
        inner = [_plain_type(each) for each in kind.types]
        return types.BaseTuple.from_types(inner, getattr(kind, "instance_class", None))
    if isinstance(kind, Mask):
        return types.boolean
    return types.float64 if isinstance(kind, Lanes) else kind


@intrinsic
def of_lane(typing: Any, value: Any, lane: Any) -> Any:
    """What one lane holds of a value."""
    whole = _plain_type(value)

    def emit(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        place = builder.trunc(args[1], PLACE)

        def taken(kind: Any, part: Any) -> Any:
            if isinstance(kind, types.BaseTuple):
                inner = [
                    taken(each, builder.extract_value(part, k))
                    for k, each in enumerate(kind.types)
                ]
                return context.make_tuple(builder, _plain_type(kind), inner)
            return builder.extract_element(part, place) if is_vector(kind) else part

        return _counted(context, builder, whole, taken(value, args[0]))

    return whole(value, types.intp), emit


def _row(context: Any, builder: Any, kind: Any, array: Any, index: Any) -> Any:
    """Pointer to the eight numbers at a place of an array whose last axis is lanes."""
    made = context.make_array(kind)(context, builder, array)
    first = builder.mul(index, ir.Constant(index.type, WIDTH))
    vector = ir.VectorType(ir.DoubleType(), WIDTH)
    return builder.bitcast(builder.gep(made.data, [first]), vector.as_pointer())


def taken(context: Any, builder: Any, kind: Any, array: Any, rows: Any, at: Any) -> Any:
    """Emit the reading of a row as a kind: numbers, flags or one whole number."""
    numbers = builder.load(_row(context, builder, array, rows, at), align=8)
    if isinstance(kind, types.Boolean):
        zeros = ir.Constant(numbers.type, [0.0] * WIDTH)
        return builder.fcmp_unordered("!=", numbers, zeros)
    if isinstance(kind, types.Integer):
        first = builder.extract_element(numbers, PLACE(0))
        return context.cast(builder, first, types.float64, kind)
    return numbers


@intrinsic
def load(typing: Any, array: Any, index: Any) -> Any:
    """Eight numbers that lie side by side, the `index`-th eight of an array."""

    def emit(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        return builder.load(_row(context, builder, array, *args), align=8)

    return NUMBERS(array, types.intp), emit


@intrinsic
def gathered(typing: Any, array: Any, index: Any) -> Any:
    """A number of an array for each lane, at the places that whole numbers tell."""

    def emit(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        made = context.make_array(array)(context, builder, args[0])
        places = builder.fptosi(args[1], ir.VectorType(ir.IntType(64), WIDTH))
        found = ir.Constant(ir.VectorType(ir.DoubleType(), WIDTH), ir.Undefined)
        for lane in range(WIDTH):
            place = builder.extract_element(places, PLACE(lane))
            number = builder.load(builder.gep(made.data, [place]))
            found = builder.insert_element(found, number, PLACE(lane))
        return found

    return NUMBERS(array, NUMBERS), emit


@intrinsic
def store(typing: Any, array: Any, index: Any, value: Any) -> Any:
    """Put eight numbers, or flags as 1 and 0, where `load` finds them."""

    def emit(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        numbers = args[2]
        if isinstance(value, Mask):
            vector = ir.VectorType(ir.DoubleType(), WIDTH)
            numbers = builder.uitofp(numbers, vector)
        place = _row(context, builder, array, args[0], args[1])
        builder.store(numbers, place, align=8)
        return context.get_dummy_value()

    return types.void(array, types.intp, value), emit


@extending.overload(operator.setitem, strict=False)
def _set_row(array: Any, index: Any, value: Any) -> Any:
    """Rows of eight are filled as rows of numbers are."""
    if is_vector(value) and isinstance(index, types.Integer):
        return lambda array, index, value: store(array, index, value)
    return None
