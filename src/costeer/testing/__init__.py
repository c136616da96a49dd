"""`check_method`: whether a method of assistance is what the loop takes it for.

A random drive, the same for the same seed, is shown to the method in plain Python and
in compiled code; then both close the loop for two seconds. What a method does for
drivers is for a study to say: here is only what every method must be.
"""

from costeer.testing.drive import MethodError
from costeer.testing.method import Finding, Report, check_method

__all__ = ["Finding", "MethodError", "Report", "check_method"]
