"""How fast it is: control step, trial, batch, and peers where installed."""
