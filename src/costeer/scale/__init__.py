"""Much work at once: threads here, workers elsewhere, shards of a batch system."""
