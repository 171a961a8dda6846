"""Many levels at once: generated, and evolved by small changes."""
