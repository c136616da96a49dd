"""What can be known of the world: the measurement, its sensors, a torque observer."""
