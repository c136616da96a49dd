"""Drivers fitted to recordings of manual driving."""
