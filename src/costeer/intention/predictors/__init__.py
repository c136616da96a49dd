"""Predictors of a lane crossing behind one interface, a file each."""
