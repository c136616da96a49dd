"""Methods side by side: the same drivers, roads, noise and mistakes."""
