"""The functions that `import costeer` offers; docs/python.md shows them."""
