"""What reports share: page frame, tables, figures' look, numbers as text."""
