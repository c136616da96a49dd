"""Measurements and experiments that no user's command needs: python -m benchmarks.X."""
