"""The same function for many items: in this process, in several, or on a Ray cluster."""
