"""The methods that the paper's one is compared with, each from its own publication.

docs/methods.md has their equations, what is ours in them, and where each is weak.
"""

from __future__ import annotations

from costeer.methods import (
    bandwidth,
    cooperative_status,
    fixed_sharing,
    four_design_choices,
    inclusion,
    indicator,
    lane_crossing_time,
    lane_keeping,
    pseudo_work,
    traded,
)

RIVALS = (
    lane_keeping.METHOD,
    lane_crossing_time.METHOD,
    indicator.INDICATOR,
    indicator.ACSF,
    cooperative_status.METHOD,
    pseudo_work.METHOD,
    fixed_sharing.METHOD,
    four_design_choices.METHOD,
    bandwidth.BANDWIDTH,
    bandwidth.CONSTANT,
    traded.METHOD,
    inclusion.METHOD,
)
"""In the order of the table of docs/methods.md."""
