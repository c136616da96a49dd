"""Guidance or driver as an agent of reinforcement learning (Gymnasium).

The agent takes the seat that a method or a driver model has in every trial; the loop is
that of the studies, in plain Python.
"""
