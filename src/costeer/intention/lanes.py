"""Vectors of float32 in compiled code: the alphabet of the wavefront's kernel.

Numba's loops are vectorised by LLVM as it sees fit: half of the machine's width on
processors with AVX-512, and no accumulators kept in registers. The kernel therefore
says what it wants. `Lanes` is a vector while LLVM code is being written: `a * b + c`
in Python emits the instructions, and a Python loop is an unrolled loop.
"""

from __future__ import annotations

from typing import NamedTuple

import llvmlite.binding
from llvmlite import ir


class LaneLayout(NamedTuple):
    """How many window starts one register and one tile of the kernel hold.

    Attributes:
        width: Floats in one vector register [-].
        vectors: Vectors side by side in a tile, such that a tile's sums (six rows
            of so many vectors) stay in the machine's registers [-].
    """

    width: int
    vectors: int


def host_layout() -> LaneLayout:
    """The layout for this processor: 32 registers of 16, 16 of 8, or NEON's 32 of 4.

    It changes speed only: each lane goes through the same operations in each layout.
    """
    features = llvmlite.binding.get_host_cpu_features()
    if features.get("avx512f"):
        return LaneLayout(width=16, vectors=4)
    if features.get("avx"):
        return LaneLayout(width=8, vectors=2)
    return LaneLayout(width=4, vectors=4 if features.get("neon") else 2)


class Lanes:
    """A vector value in the LLVM code that is being written."""

    def __init__(self, builder: ir.IRBuilder, value: ir.Value) -> None:
        self.builder = builder
        self.value = value

    def __add__(self, other: Lanes) -> Lanes:
        return Lanes(self.builder, self.builder.fadd(self.value, other.value))

    def __sub__(self, other: Lanes) -> Lanes:
        return Lanes(self.builder, self.builder.fsub(self.value, other.value))

    def __mul__(self, other: Lanes) -> Lanes:
        return Lanes(self.builder, self.builder.fmul(self.value, other.value))

    def __truediv__(self, other: Lanes) -> Lanes:
        return Lanes(self.builder, self.builder.fdiv(self.value, other.value))

    def like(self, number: float) -> Lanes:
        """The same number in every lane."""
        return Lanes(self.builder, ir.Constant(self.value.type, [number] * self.width))

    @property
    def width(self) -> int:
        """Floats in the vector."""
        return int(self.value.type.count)


def fused(a: Lanes, b: Lanes, c: Lanes) -> Lanes:
    """Return a · b + c, rounded once where the machine can."""
    return _call("llvm.fmuladd", a, b, c)


def clamped(x: Lanes, limit: float) -> Lanes:
    """`x` held within ±limit."""
    low = _call("llvm.minnum", x, x.like(limit))
    return _call("llvm.maxnum", low, x.like(-limit))


def _call(name: str, *arguments: Lanes) -> Lanes:
    builder, kind = arguments[0].builder, arguments[0].value.type
    signature = ir.FunctionType(kind, [kind] * len(arguments))
    typed_name = f"{name}.v{kind.count}f32"
    function = builder.module.globals.get(typed_name)
    if function is None:
        function = ir.Function(builder.module, signature, typed_name)
    return Lanes(builder, builder.call(function, [a.value for a in arguments]))


def splat(builder: ir.IRBuilder, value: ir.Value, width: int) -> Lanes:
    """A scalar float32 in every lane."""
    kind = ir.VectorType(ir.FloatType(), width)
    undefined = ir.Constant(kind, ir.Undefined)
    index = ir.IntType(32)
    first = builder.insert_element(undefined, value, index(0))
    order = ir.Constant(ir.VectorType(index, width), [0] * width)
    return Lanes(builder, builder.shuffle_vector(first, undefined, order))


class Floats:
    """A float32 array in the LLVM code that is being written, addressed flat."""

    def __init__(self, builder: ir.IRBuilder, pointer: ir.Value) -> None:
        self.builder = builder
        self.pointer = pointer

    def scalar(self, index: ir.Value, width: int) -> Lanes:
        """The element at `index`, in every lane."""
        return splat(self.builder, self.builder.load(self._at(index)), width)

    def vector(self, index: ir.Value, width: int) -> Lanes:
        """The `width` elements from `index` on."""
        pointer = self._as_vector(index, width)
        return Lanes(self.builder, self.builder.load(pointer, align=4))

    def store(self, index: ir.Value, lanes: Lanes) -> None:
        """Write the vector from `index` on."""
        pointer = self._as_vector(index, lanes.width)
        self.builder.store(lanes.value, pointer, align=4)

    def _at(self, index: ir.Value) -> ir.Value:
        return self.builder.gep(self.pointer, [index])

    def _as_vector(self, index: ir.Value, width: int) -> ir.Value:
        kind = ir.VectorType(ir.FloatType(), width).as_pointer()
        return self.builder.bitcast(self._at(index), kind)


# Rational approximation of tanh, odd over even, in x² up to the eighth power: minimax
# for the absolute error on [-9, 9], 1.9e-8, found by Lawson's iteration. Beyond 9 tanh
# is 1 to 3e-8. In float32 the largest error is 4e-7 (tests/intention/test_lanes.py).
_LIMIT = 9.0
_ABOVE = (
    0.9999999063523605,
    0.1337319658343978,
    0.003486580595567297,
    2.047181021537455e-05,
    1.3184197855679085e-08,
)
_BELOW = (
    1.0,
    0.467064934457888,
    0.02584197419281532,
    0.0003271383308295634,
    7.702652379551508e-07,
)


def tanh_fraction(x: Lanes) -> tuple[Lanes, Lanes]:
    """Numerator and denominator of tanh(x), so that divisions can be shared."""
    x = clamped(x, _LIMIT)
    square = x * x
    return x * _polynomial(square, _ABOVE), _polynomial(square, _BELOW)


def _polynomial(x: Lanes, coefficients: tuple[float, ...]) -> Lanes:
    value = x.like(coefficients[-1])
    for coefficient in coefficients[-2::-1]:
        value = fused(value, x, x.like(coefficient))
    return value


def tanh(x: Lanes) -> Lanes:
    """Hyperbolic tangent of every lane."""
    above, below = tanh_fraction(x)
    return above / below


def logistic_pair(half_a: Lanes, half_b: Lanes) -> tuple[Lanes, Lanes]:
    """1/(1 + exp(-a)) and the same of b, from a/2 and b/2, with one division.

    The logistic function is (1 + tanh(a/2))/2, and 1/p and 1/q cost one division:
    1/(pq), times q and times p. Division is the slowest instruction here.
    """
    above_a, below_a = tanh_fraction(half_a)
    above_b, below_b = tanh_fraction(half_b)
    half = half_a.like(0.5)
    half_inverse = half / (below_a * below_b)
    scaled_a, scaled_b = half_inverse * below_b, half_inverse * below_a
    return fused(above_a, scaled_a, half), fused(above_b, scaled_b, half)
