"""Follow an optimal policy for one episode: python examples/play.py [LEVEL]"""

import argparse

from arguments import level_of

import babyrobot_levels as brl

parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("level", type=level_of, nargs="?", default="final-maze")
level = parser.parse_args().level
if level.has_random_maze:
    level = level.with_maze_seed(0)

try:
    solution = brl.solve(level)
except ArithmeticError:  # without a discount, the return of this level has no value
    solution = brl.solve(level, discount=0.99)

policy, mdp = solution.policy.ravel(), level.compile()
limit = level.max_steps or 1000
env = level.make(observation="index", render_mode="ansi", max_episode_steps=limit)
state, _ = env.reset(seed=0)
env.unwrapped.show_info({"policy": solution})
print(env.render())

names, total, terminated, truncated = [], 0.0, False, False
while not (terminated or truncated):
    action = brl.Action(policy[state])
    state, reward, terminated, truncated, _ = env.step(action)
    names.append(action.name.lower())
    total += float(reward)

x, y = mdp.cell(int(state))
more = f" … {len(names) - 40} more" if len(names) > 40 else ""
print("actions:", " ".join(names[:40]) + more)
end = "truncated at" if truncated else "at the exit" if (x, y) in level.exits else "terminated at"
print(f"{level.name}: {end} [{x}, {y}] after {len(names)} steps, return {total:g}")
print(f"expected return of this policy, which is optimal: {solution.expected_return:.2f}")
