"""Evidence that gathers until a driver acts on it, instead of a fixed threshold.

What is beyond the usual counts, what is within it counts against, and what is old is
forgotten (accumulation to a bound; Markkula, Boer, Romano and Merat 2018). Whether a
wheel angle is corrected (tolerance.py) and whether a lane change is planned anew
(correcting.py) are decided by it.
"""

from __future__ import annotations

from costeer.base import array as xp
from costeer.base.array import Real, compiled


@compiled
def gathered(
    rate: Real,
    usual: Real,
    forgetting_time: Real,
    evidence: Real,
    error: Real,
    dt: Real,
) -> Real:
    """Evidence one step later, A' = r (|e| / e_0 - 1) - A / τ, never negative [-].

    Args:
        rate: r, how fast evidence gathers at twice the usual error [1/s].
        usual: e_0, that nobody minds, in the unit of the error.
        forgetting_time: τ [s].
        evidence: A [-].
        error: e, in its own unit.
        dt: Control step [s].
    """
    beyond = xp.absolute(error) / xp.maximum(usual, 1e-9) - 1.0
    change = rate * beyond - evidence / forgetting_time
    return xp.maximum(evidence + change * dt, 0.0)
