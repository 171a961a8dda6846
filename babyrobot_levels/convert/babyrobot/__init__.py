"""The keyword setups of PyPI babyrobot 1.0.40: the game is the one that the package plays."""
