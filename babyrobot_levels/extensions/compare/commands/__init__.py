"""`babyrobot compare` and `babyrobot diff`."""
