# mypy: disable-error-code="import-not-found,import-untyped,misc,no-untyped-call"
"""gym-sokoban, asked by `sokoban.py`. Runs in an environment of its own; see `peers.py`."""

import json
import random
import sys
from typing import Any

import numpy as np
from gym_sokoban.envs.room_utils import generate_room
from gym_sokoban.envs.sokoban_env import SokobanEnv

WALL, FLOOR, TARGET, ON_TARGET, BOX, PLAYER = range(6)
"""What is in the cells of a room."""


class Room(SokobanEnv):
    """A room that is given, with walls around, and without pictures, which cost most."""

    def __init__(self, fields: dict[str, Any]) -> None:
        super().__init__(num_boxes=len(fields["boxes"]), max_steps=sys.maxsize, reset=False)
        width, height = fields["size"]
        self.room_fixed = np.full((height + 2, width + 2), WALL)
        self.room_fixed[1:-1, 1:-1] = FLOOR
        for kind, mark in (("blocked", WALL), ("targets", TARGET)):
            for entry in fields[kind]:
                self.room_fixed[entry["at"][1] + 1, entry["at"][0] + 1] = mark

    def put(self, robot: list[int], boxes: list[list[int]]) -> None:
        """Begin with player and boxes in some cells `[x, y]`."""
        self.room_state = self.room_fixed.copy()
        for x, y in boxes:
            is_target = self.room_fixed[y + 1, x + 1] == TARGET
            self.room_state[y + 1, x + 1] = ON_TARGET if is_target else BOX
        self.player_position = np.array([robot[1] + 1, robot[0] + 1])
        self.room_state[tuple(self.player_position)] = PLAYER
        self.num_env_steps, self.boxes_on_target = 0, int((self.room_state == ON_TARGET).sum())

    def render(self, mode: str = "human", close: Any = None, scale: int = 1) -> None:
        """Draw nothing."""

    def take(self, action: int) -> list[Any]:
        """Return player, boxes, reward and whether the episode is over after an action."""
        _, reward, done, _ = self.step(action)
        boxes = np.argwhere(np.isin(self.room_state, (ON_TARGET, BOX)))
        player, *others = (np.vstack([self.player_position, boxes]) - 1)[:, ::-1].tolist()
        return [player, sorted(others), float(reward), bool(done)]


def drawn(seed: int) -> list[str]:
    """Return a room of the package's own generator, as lines of characters: 7 by 7, two boxes."""
    random.seed(seed)
    np.random.seed(seed)  # noqa: NPY002
    while True:
        try:
            fixed, state, *_ = generate_room(dim=(7, 7), num_steps=25, num_boxes=2)
            break
        except RuntimeWarning:
            # No box could be pulled: the environment draws again as well.
            continue
    # A player hides the target beneath.
    state = np.where((fixed == TARGET) & (state == PLAYER), PLAYER + 1, state)
    return ["".join("# .*$@+"[kind] for kind in row) for row in state]


def main() -> None:
    """Answer questions until there are none."""
    for line in sys.stdin:
        question = json.loads(line)
        if "seed" in question:
            print(json.dumps(drawn(question["seed"])), flush=True)
            continue
        room, answers = Room(question["fields"]), []
        for robot, boxes, actions in question["plays"]:
            room.put(robot, boxes)
            answers.append([room.take(action) for action in actions])
        print(json.dumps(answers), flush=True)


if __name__ == "__main__":
    main()
