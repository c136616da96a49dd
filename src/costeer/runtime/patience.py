"""How long each part of a drive waits for another before it acts."""

from __future__ import annotations

PAGE_PATIENCE = 1.0
"""A drive pauses when no page has said a word for so long [s]."""

SERVER_PATIENCE = 5.0
"""The process ends when the server has shown no life for so long [s]."""

WHEEL_PATIENCE = 0.05
"""A reading older than this is stale [s]; with the guard's fall it ends by 100 ms."""

VERDICT_PATIENCE = 6
"""Frames after which the network's last verdict no longer counts [-]."""

WATCHDOG_PATIENCE = 0.3
"""A watchdog that has not looked for so long watches nobody [s]."""

STOP_PATIENCE = 0.4
"""The torque has faded out by then; the process ends anyhow [s]."""
