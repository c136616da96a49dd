"""What `costeer bench` prints: control step, trials, batch, peers, pace of a drive."""
