"""The network that reads the driver: features (Eq. 1), GRU (Eq. 2), weights."""
