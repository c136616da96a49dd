"""Steering wheels: one small protocol in N·m and rad, a file per kind of device."""
