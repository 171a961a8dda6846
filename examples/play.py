"""Plays one episode of a level with random moves: python examples/play.py [LEVEL]"""

import argparse

from arguments import level_of

parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("level", type=level_of, nargs="?", default="final-maze")
level = parser.parse_args().level
env = level.make(render_mode="ansi", max_episode_steps=10_000)
env.action_space.seed(1)
observation, info = env.reset(seed=1)
print(env.render())

total, steps, terminated, truncated = 0.0, 0, False, False
while not (terminated or truncated):
    action = env.action_space.sample()  # only actions that the mask allows
    observation, reward, terminated, truncated, info = env.step(action)
    total, steps = total + float(reward), steps + 1

print(env.render())
end = "terminated" if terminated else "truncated"
print(f"{level.name}: {steps} steps, return {total:g}, {end} at {observation.tolist()}")
