"""The methods that the paper's one is compared with, each from its own publication.

docs/methods.md has their equations, what is ours in them, and where each is weak.
"""

from __future__ import annotations

from costeer.methods import fixed_sharing, lane_keeping

RIVALS = (
    lane_keeping.METHOD,
    fixed_sharing.METHOD,
)
"""In the order of the table of docs/methods.md."""
