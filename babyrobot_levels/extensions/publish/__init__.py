"""Many levels for people who have nothing installed: galleries to browse and play, hand-outs."""
