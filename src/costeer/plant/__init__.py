"""What the world does: tyre, vehicle, steering column, traffic and road."""
