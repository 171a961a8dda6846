"""Records episodes with Gymnasium's wrappers: python examples/record_video.py --folder videos

It needs MoviePy: pip install moviepy
"""

from __future__ import annotations

from pathlib import Path

import gymnasium
import numpy as np
from arguments import at_least, parsed, parser_of
from gymnasium.wrappers import RecordEpisodeStatistics, RecordVideo

import babyrobot_levels as brl


def main() -> None:
    parser = parser_of(__doc__, steps=200, steps_help="the time limit of episodes")
    parser.add_argument("--episodes", type=at_least(1), default=4)
    parser.add_argument("--folder", type=Path, default=Path("videos"))
    args = parsed(parser)

    env = gymnasium.make(
        "babyrobot/Level-v0",
        level=args.level,
        render_mode="rgb_array",
        max_episode_steps=args.steps,
    )
    # Every other episode is recorded.
    env = RecordVideo(env, str(args.folder), episode_trigger=lambda episode: episode % 2 == 0)
    env = RecordEpisodeStatistics(env, buffer_length=args.episodes)
    solution = brl.solve(args.level)
    for episode in range(args.episodes):
        (x, y), _ = env.reset(seed=args.seed + episode)
        done = False
        while not done:
            (x, y), _, terminated, truncated, _ = env.step(solution.policy[y, x])
            done = terminated or truncated
    env.close()

    for number, (total, length) in enumerate(zip(env.return_queue, env.length_queue, strict=True)):
        print(f"episode {number}: {length} steps, return {total:g}")
    print(f"mean return {np.mean(env.return_queue):.2f}")
    print(f"expected    {solution.expected_return:.2f}, exactly")
    for path in sorted(args.folder.glob("*.mp4")):
        print(path)


if __name__ == "__main__":
    main()
