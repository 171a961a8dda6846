"""`babyrobot score` and `babyrobot replay`."""
