"""The words, tables, figures and page of the drivers' validation report."""
