"""Roads, other cars and events as data: scenarios, their files and what they become."""
