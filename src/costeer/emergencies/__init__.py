"""Emergencies: an obstacle appears; driver and guidance may want different things."""
