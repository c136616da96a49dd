"""Who holds the wheel: vision, arms, reliance, decision, gaze, population."""
