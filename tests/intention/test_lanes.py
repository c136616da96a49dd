"""The kernel's own functions against NumPy's, over all they may meet."""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import njit, types
from numba.core import cgutils
from numba.extending import intrinsic
from numpy.typing import NDArray

from costeer.intention.lanes import Floats, host_layout, logistic_pair, tanh

WIDTH = host_layout().width


def _functions(typingctx: Any, source: Any, target: Any, index: Any) -> Any:
    """Write tanh(x), and sigmoid of 2x and of -2x by `logistic_pair`."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        arrays = [
            context.make_array(kind)(context, builder, value)
            for kind, value in zip(signature.args[:2], arguments[:2], strict=True)
        ]
        values, results = (Floats(builder, array.data) for array in arrays)
        x = values.vector(arguments[2], WIDTH)
        pair = logistic_pair(x, x.like(0.0) - x)
        row = arguments[2]
        for value in (tanh(x), *pair):
            results.store(row, value)
            row = builder.add(row, cgutils.intp_t(2 * 10**6))
        return context.get_dummy_value()

    return types.void(source, target, index), generate


functions: Any = intrinsic(_functions)


@njit
def evaluate(source: NDArray[np.float32], target: NDArray[np.float32]) -> None:
    for start in range(0, source.shape[0], WIDTH):
        functions(source, target, start)


def evaluated() -> tuple[NDArray[np.float64], NDArray[np.float32]]:
    x = np.linspace(-30.0, 30.0, 2 * 10**6).astype(np.float32)
    target = np.empty((3, x.size), np.float32)
    evaluate(x, target)
    return x.astype(np.float64), target


def test_tanh_and_sigmoid_err_by_less_than_stated() -> None:
    x, (hyperbolic, logistic, mirrored) = evaluated()
    # The fit errs by 2e-8; the polynomials and the division round to float32.
    assert np.abs(hyperbolic - np.tanh(x)).max() < 4e-7
    expected = 0.5 + 0.5 * np.tanh(x)
    assert np.abs(logistic - expected).max() < 3e-7
    assert np.abs(mirrored - expected[::-1]).max() < 3e-7
