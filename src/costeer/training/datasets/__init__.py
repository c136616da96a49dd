"""Recordings of people from public sets: one file a set, and what they share."""
