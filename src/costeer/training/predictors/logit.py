"""The logistic fits that all predictors share, by scikit-learn."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from sklearn.linear_model import LogisticRegression

from costeer.training.predictors.samples import Answers


class LogitFit(NamedTuple):
    """A fitted logit.

    Attributes:
        coefficients: Of the columns, `(column,)`.
        intercept: [-].
    """

    coefficients: NDArray[np.float64]
    intercept: float


def fit_logit(
    numbers: NDArray[np.float64], answers: Answers, penalty_inverse: float = 1e6
) -> LogitFit:
    """Weighted logistic regression with an L2 penalty.

    Args:
        numbers: Columns of about unit size, shape `(window, column)`.
        answers: Of the windows.
        penalty_inverse: C, inverse strength of the penalty on one window's loss [-];
            large for none.
    """
    model = LogisticRegression(
        C=penalty_inverse, solver="newton-cholesky", max_iter=100, tol=1e-4
    )
    model.fit(numbers, answers.positive, sample_weight=answers.weight)
    return LogitFit(np.asarray(model.coef_[0]), float(model.intercept_[0]))


def logit_loss(logit: NDArray[np.float64], answers: Answers) -> float:
    """Weighted log loss of logits [nat]."""
    sign = np.where(answers.positive, -1.0, 1.0)
    return float(np.average(np.logaddexp(0.0, sign * logit), weights=answers.weight))
