"""Approximate Q-learning: action values as a weighted sum of features, learned from episodes."""

import numpy as np


def features(level, state, action):
    """Return the features of a state and an action, a vector of floats.

    These are one for each state and action, so that nothing is shared: it is Q-learning once more.
    Find fewer that tell as much, such as the distance to the exit, or what lies ahead.
    """
    mdp = level.compile()
    found = np.zeros((mdp.num_states, mdp.num_actions))
    found[state, action] = 1.0
    return found.ravel()


def approximate_q(level):
    """Return a policy that earns nearly the optimum: an action for each state.

    The value of an action is `weights @ features(level, state, action)`. A step moves the weights
    by the step size times the error of that value times the features.
    """
    mdp = level.compile()
    weights = np.zeros(features(level, 0, 0).size)
    # YOUR CODE HERE
    raise NotImplementedError
    values = [
        [weights @ features(level, state, action) for action in range(mdp.num_actions)]
        for state in range(mdp.num_states)
    ]
    # Actions that are not possible were not learned: their values may be more than others have.
    possible = np.where(mdp.action_mask, values, -np.inf)
    return np.argmax(possible, axis=1).reshape(mdp.shape)
