"""Learning intention from records: labels, data sets, fit and evaluation."""
