"""People and the wall clock: wheels, heads, the real-time loop and its streams."""
