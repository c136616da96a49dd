"""Cheaper forms of the exact window, what they cost and what they change."""
