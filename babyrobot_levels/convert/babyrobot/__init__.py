"""The keyword setups of PyPI babyrobot 1.0.40, with the MDP that the package plays."""
