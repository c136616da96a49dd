"""What a trial leaves: columns declared once, rows, files."""
