"""What the browser sees: pages, the socket of a drive, replays, and who may ask."""
