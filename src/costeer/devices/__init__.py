"""What is plugged into the computer: wheels and head trackers, behind two protocols."""
