"""What others call the fields and the values of levels, and where else what they mean is."""

from __future__ import annotations

OTHER_NAMES = {
    # Of a level.
    "size": "width height row rows col cols column dimension dim grid grid_size shape",
    "start": "robot player start_po start_pos agent_po agent_pos agent_start_pos initial_state "
    "spawn",
    "exit": "target terminal terminal_state finish goal_pos goal_po",
    "discount": "gamma discount_factor",
    "max_steps": "horizon time_limit max_episode_steps max_episode_step episode_length step limit "
    "timeout",
    "skid": "slip slippery is_slippery slipperiness slip_prob slip_probability noise "
    "random_action_prob",
    "areas": "terrain zone region",
    "puddles": "water",
    "blocked": "rock block pillar solid",
    "items": "object treasure gem pickup",
    "movers": "npc ghost patrol ball",
    "switches": "plate",
    "warps": "tunnel",
    "rewards": "step_reward living_reward living_cost step_cost penalty",
    "maze": "seed algorithm generator random",
    "walls": "barrier fence",
    "theme": "color colour colors style",
    "tags": "keyword category",
    "map": "drawing layout ascii desc level tile",
    "count": "n num number num_level num_levels amount",
    # Of its parts.
    "at": "po pos position cell location coord coordinate coordinates x y from row col column",
    "path": "to route waypoint",
    "side": "direction dir edge facing orientation",
    "needs": "key locked open requires required",
    "name": "id type kind",
    "algorithm": "method generator type kind",
    "loops": "braid braiding",
    "ends": "terminal terminate done end is_terminal",
    "reward": "value cost penalty",
    "pass": "probability prob p",
    "probability": "prob p q",
    "step": "living time default move",
    "bump": "wall collision",
    "north": "up",
    "east": "right",
    "south": "down",
    "west": "left",
    "base": "background bg ground floor",
    "text_fg": "text foreground fg",
    "border": "outline frame",
    # Of what is expected.
    "best_return": "return value score reward optimal_return optimum",
    "best_steps": "step expected_step optimal_step",
    "random_return": "random",
    "path_length": "path length distance shortest_path",
    "success": "exit exit_probability win goal solvable",
    "states": "num_state size",
    "cells": "num_cell",
    "difficulty": "hardness",
}
"""What other programs and everyday speech call a field, for `did you mean`; without a last `s`."""

ELSEWHERE = (
    ("version", "action actions action_space", "the actions are stay, north, east, south and west; "
     'environments can turn instead: `gymnasium.make(…, actions="turns")`'),
    ("version", "observation observations obs observation_space", "environments choose it: "
     '`gymnasium.make(…, observation="planes")`'),
    ("version", "transitions transition p", "they follow from what stands in the level; "
     "`level.compile()` has them"),
    ("version", "episode episodes", "a level is one world; `babyrobot score` plays episodes in it"),
    ("version", "policy", "a policy is a file of its own; `babyrobot solve` finds the best one"),
    ("version", "success_rate success_prob", "it is `skid` seen from the other side: "
     "`skid: 0.2` for moves that succeed with 0.8"),
    ("version", "reward_range", "it follows from the rewards: leave it out"),
    ("areas", "hole holes lava trap traps pit pits cliff cliffs", "each is an area that ends the "
     "episode: `areas: [{at: [x, y], reward: -10, ends: true}]`"),
    ("colors widths", "background bg ground base walls border", "colours are one level deeper: "
     "`theme: {colors: {base: white}}`"),
    ("areas", "ice mud", "it is an area in which the robot skids: "
     "`areas: [{at: [x, y], skid: 0.2}]`"),
    ("version", "slippery is_slippery", "write `skid: 0.2` for one move in five that slips; "
     "FrozenLake's ice is `skid: {probability: 0.6666666666666667, to: sides}`"),
    ("version", "render_mode fps", "environments choose it: `gymnasium.make(…, render_mode=…)`"),
    ("map", "count split splits levels train test", "a suite has it: add `kind: suite`"),
    ("splits", "train test validation", "write `splits: {train: 0.8, test: 0.2}`"),
    ("states", "lint", "it is for level files: generate the levels, and lint them"),
    ("splits", "walls start exit doors map areas switches movers", "a suite grows its mazes; "
     "with `levels: [name, …]` it lists levels of your own"),
    ("algorithm loops", "seed", "the suite has one `seed`, from which each maze gets its own"),
    ("bump", "hole lava trap area", "it stands with the area: `areas: [{…, reward: -10}]`"),
    ("bump", "puddle small large", "it stands in `puddle_types: {small: {reward: -3}}`"),
    ("bump", "hit mover guard", "it stands in `hit: {reward: -10}`"),
    ("bump", "item key coin", "it stands with the item: `items: [{…, reward: 5}]`"),
    ("bump", "warp", "it stands with the warp: `warps: [{…, reward: 1}]`"),
    ("switch", "puddle", "a puddle is drawn as `o` or `O`"),
    ("switch", "start", "a start is drawn as `S`"),
    ("switch", "exit goal", "an exit is drawn as `E`"),
    ("switch", "wall", "a wall is drawn between two cells, `|` or `---`"),
    ("switch", "door", "a door is drawn between two cells, `/` or `-/-`"),
    ("switch", "mover guard", "movers are listed in `movers`"),
    ("switch", "warp", "warps are listed in `warps`"),
    ("side", "from to between cells", "it has one cell and a side: `{at: [x, y], side: E}`"),
    ("path", "at pos position", "a mover has a `path` of cells, or walks `within` a rectangle"),
    ("ends", "rect rectangle to from until", "an area has a corner and a size: "
     "`{at: [x, y], size: [2, 1]}`"),
    ("ends", "type kind", "what it is follows from its `reward`, `skid` and `ends`"),
    ("once", "toggles opens closes controls door doors target", "it stands with the door: "
     "`doors: [{…, needs: name}]`"),
    ("count", "metric metrics", "each metric is a field of its own: `difficulty: 3..5`"),
    ("path", "from to", "list all cells of its way: `path: [[0, 1], [1, 1]]`, `back: true`"),
    ("path", "speed velocity", "a mover makes one step in each step of the robot"),
)  # fmt: skip
"""What is no field, and where that is; in mappings with a field, or with exactly these fields."""

OTHER_CHOICES = {
    "depth-first": ("dfs", "recursive-backtracker", "recursive-backtracking", "backtracking"),
    "large": ("big", "huge"),
    "small": ("little", "tiny", "medium"),
    "others": ("any", "random"),
    "sides": ("perpendicular", "left-right"),
}
"""What other programs call a value that is one of several."""

DIRECTIONS = {
    **dict.fromkeys(("up", "top", "above"), "N"),
    **dict.fromkeys(("right",), "E"),
    **dict.fromkeys(("down", "bottom", "below"), "S"),
    **dict.fromkeys(("left",), "W"),
}
"""Other words for the sides of a cell."""
