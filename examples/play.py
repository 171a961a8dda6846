"""Plays one episode of a level with random moves: python examples/play.py [LEVEL]"""

import sys

import babyrobot_levels as brl

level = brl.load(sys.argv[1] if len(sys.argv) > 1 else "final-maze")
env = level.make(render_mode="ansi", max_episode_steps=10_000)
env.action_space.seed(1)
observation, info = env.reset(seed=1)
print(env.render())

total, steps, terminated, truncated = 0.0, 0, False, False
while not (terminated or truncated):
    action = env.action_space.sample()  # only moves that are possible here
    observation, reward, terminated, truncated, info = env.step(action)
    total, steps = total + float(reward), steps + 1

print(env.render())
end = "at an exit" if terminated else "cut off"
print(f"{level.name}: {steps} steps, return {total:g}, {end} at {observation.tolist()}")
