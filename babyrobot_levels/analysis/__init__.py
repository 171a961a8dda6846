"""Numbers about a level: metrics, solutions, learning, comparisons and differences."""
