"""Whether two levels are the same MDP, and what differs between them."""
