"""The experiment: conditions, design, measures, statistics, figures and report."""
