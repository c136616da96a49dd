"""The clock of the loop."""

DT = 1.0 / 60.0
"""Control step [s]."""
