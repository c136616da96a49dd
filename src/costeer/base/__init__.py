"""Mathematics without cars: angles, curves, integration, windows, filters, array engine."""
