"""Virtual drivers held against human values."""
