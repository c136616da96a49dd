"""What can be known of the world: the measurement and its sensors."""
