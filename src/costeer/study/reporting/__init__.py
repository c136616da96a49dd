"""The words, tables and page of a study's report."""
