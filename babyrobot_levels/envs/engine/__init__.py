"""Many robots at once: flat tables of levels, and two engines that walk them the same way."""
