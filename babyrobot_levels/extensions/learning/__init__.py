"""Learning a level step by step: textbook algorithms that can be watched while they converge."""
