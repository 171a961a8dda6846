"""Value iteration: the optimal values of a level, by sweeps over its tables."""

import numpy as np


def value_iteration(level):
    """Return the optimal values, an array of the shape `level.compile().shape`.

    Sweep over all states until the largest change is below 1e-6. What you need:

        mdp = level.compile()
        mdp.probability[state, action]   the probability of each outcome
        mdp.next_state[state, action]    the next state of each outcome
        mdp.reward[state, action]        the reward of each outcome
        mdp.terminal[state, action]      whether the outcome ends the episode
        mdp.is_terminal[state]           whether no step follows in the state: its value is 0
        mdp.num_states, mdp.num_actions
        level.discount

    All of these are arrays: `mdp.probability` is `[states, actions, outcomes]`.
    """
    mdp = level.compile()
    values = np.zeros(mdp.num_states)
    # YOUR CODE HERE
    raise NotImplementedError
    return values.reshape(mdp.shape)
