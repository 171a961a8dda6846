"""What a level comes to: its walls, its mazes, and the exact tables of its MDP."""
