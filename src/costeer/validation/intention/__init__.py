"""What intention predictors are worth: figures, tables and a page."""
