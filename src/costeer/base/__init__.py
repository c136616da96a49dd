"""Mathematics without cars: curves, integration, windows, filters, array engine."""
