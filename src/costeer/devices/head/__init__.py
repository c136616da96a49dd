"""Where the driver's head points: a webcam, a tracker over LSL, or opentrack.

Only the head's yaw and its validity leave this folder; no picture and no landmark is
kept or written.
"""
