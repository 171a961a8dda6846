"""What a step comes to: the next state after warps, and the reward, in the language's order."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from babyrobot_levels.language.moves import Rewards
from babyrobot_levels.mdp.actions import NUM_ACTIONS, Action
from babyrobot_levels.mdp.compiler.branches import Branches, Floats, Ints
from babyrobot_levels.mdp.compiler.terrain import Terrain
from babyrobot_levels.mdp.compiler.warps import Warps


@dataclass(frozen=True, eq=False)
class Arrivals:
    """Answers where branches end and what they are worth."""

    rewards: Rewards
    terrain: Terrain
    warps: Warps

    def next_states(self, branches: Branches) -> Ints:
        """Return the next states; the number of states stands for "one of the starts"."""
        state, action = np.divmod(branches.row, NUM_ACTIONS)
        stays = (action == Action.STAY) | self.terrain.over[state]
        arrived = np.where(stays, branches.landing, self.warps.arrive[branches.landing])
        leaves = self.warps.leaves[state] & ~stays
        return np.where(leaves, self.warps.leave_to[state], arrived)

    def rewards_of(self, branches: Branches, next_state: Ints) -> Floats:
        """Return the rewards of branches that end on `next_state`."""
        state, action = np.divmod(branches.row, NUM_ACTIONS)
        stays = action == Action.STAY
        rewards, terrain, warps = self.rewards, self.terrain, self.warps
        reward = terrain.reward[next_state]
        if terrain.distance is not None:
            before, after = terrain.distance[state], terrain.distance[next_state]
            if rewards.closer is not None:
                reward = np.where(after < before, rewards.closer, reward)
            if rewards.farther is not None:
                reward = np.where(after > before, rewards.farther, reward)
        if rewards.bump is not None:
            reward = np.where(branches.bumped, rewards.bump, reward)
        if rewards.stay is not None:
            reward = np.where(stays, rewards.stay, reward)
        reward = np.where(terrain.exit[next_state], rewards.exit, reward)
        warped = np.where(stays, np.nan, warps.arrive_reward[branches.landing])
        warped = np.where(warps.leaves[state] & ~stays, warps.leave_reward[state], warped)
        reward = np.where(np.isnan(warped), reward, warped)
        reward = reward + np.where(branches.bounced, rewards.bounce, 0.0)
        return np.where(terrain.over[state], 0.0, reward)
