"""How weights go down a slope: the rule that the network and its rivals share."""

from __future__ import annotations

from typing import Protocol

import optax


class Rates(Protocol):
    """What the rule needs of the parameters of a fit."""

    @property
    def learning_rate(self) -> float:
        """Of Adam at its highest [-]."""
        ...

    @property
    def weight_decay(self) -> float:
        """Of Adam [-]."""
        ...

    @property
    def largest_gradient(self) -> float:
        """Norm at which a gradient is cut [-]."""
        ...

    @property
    def num_steps(self) -> int:
        """At most [-]."""
        ...


def optimiser(parameters: Rates) -> optax.GradientTransformation:
    """Adam with weight decay, a cut of large gradients and a falling rate."""
    rate = optax.warmup_cosine_decay_schedule(
        init_value=0.1 * parameters.learning_rate,
        peak_value=parameters.learning_rate,
        warmup_steps=min(100, parameters.num_steps // 10 + 1),
        decay_steps=max(parameters.num_steps, 2),
        end_value=0.01 * parameters.learning_rate,
    )
    return optax.chain(
        optax.clip_by_global_norm(parameters.largest_gradient),
        optax.adamw(rate, weight_decay=parameters.weight_decay),
    )
