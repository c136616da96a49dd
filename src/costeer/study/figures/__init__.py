"""The figures of a study, one file per kind, in one style."""
