"""What each cell does to a robot, and where moves and warps end: arrays over the cells."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from babyrobot_levels.language.base import SIDES
from babyrobot_levels.language.cells import RandomReward, Warp, gusts, shifts
from babyrobot_levels.language.fields import LevelFields
from babyrobot_levels.mdp.actions import DELTAS, NUM_MOVES, Action
from babyrobot_levels.mdp.configurations import check_room
from babyrobot_levels.mdp.grid import Grid
from babyrobot_levels.mdp.ground import build_ground
from babyrobot_levels.mdp.tables import FREE, GLASS, REFUSED, Flags, Floats, Ints
from babyrobot_levels.text import budget


@dataclass(frozen=True, eq=False)
class Draws:
    """The rewards that are drawn.

    Attributes:
        number: `[cells]`: which of the rewards a cell has; 0 for one that is not drawn.
        begin: `[rewards + 1]`: where the values of each reward begin; reward 0 has one of them.
        value: the values.
        chance: the probability of each.
    """

    number: Ints
    begin: Ints
    value: Floats
    chance: Floats

    def count(self, cell: Ints) -> Ints:
        """Return how many values the rewards of cells have."""
        count: Ints = np.diff(self.begin)[self.number[cell]]
        return count


def _build_draws(random: Mapping[int, RandomReward], cells: int) -> Draws | None:
    if not random:
        return None
    numbers = {reward: number for number, reward in enumerate(dict.fromkeys(random.values()), 1)}
    number = np.zeros(cells, np.int64)
    number[[*random]] = [numbers[reward] for reward in random.values()]
    chances = [((0.0, 1.0),), *(reward.chances for reward in numbers)]
    value, chance = np.array([each for row in chances for each in row]).T
    return Draws(number, np.cumsum([0, *map(len, chances)]), value, chance)


@dataclass(frozen=True, eq=False)
class Terrain:
    """Arrays `[states]`; a state is a cell, numbered row by row.

    Attributes:
        skid: the probability that a move out of the cell goes astray.
        rule: where it goes then, an index into `RULES`.
        reward: the reward of standing on the cell after a step; of one that is drawn, the mean.
        exit: whether the cell is an exit.
        ends: whether the episode is over there, exits left out: a cell that ends it, or blocked.
        over: whether the episode is over there: an exit, a cell that ends it, a blocked cell.
        distance: the squared straight-line distance to the nearest exit; None where there is no
            exit, or no reward asks for it.
        draws: the rewards that are drawn; None if there are none.
    """

    skid: NDArray[np.float64]
    rule: NDArray[np.int8]
    reward: NDArray[np.float64]
    exit: NDArray[np.bool_]
    ends: NDArray[np.bool_]
    over: NDArray[np.bool_]
    distance: NDArray[np.int64] | None
    draws: Draws | None = None


def build_terrain(
    level: LevelFields, grid: Grid, exits: tuple[tuple[int, int], ...] | None = None
) -> Terrain:
    """Return what the ground, the exits and blocked cells do.

    Args:
        level: the level.
        grid: its grid.
        exits: the exits, if they are not those of the level.
    """
    ground = build_ground(level)
    ends = np.frombuffer(ground.ends, bool) | grid.blocked.ravel()
    shaped = level.rewards.closer is not None or level.rewards.farther is not None
    exit_cells = level.exits if exits is None else exits
    is_exit = np.zeros((grid.height, grid.width), bool)
    for x, y in exit_cells:
        is_exit[y, x] = True
    return Terrain(
        np.frombuffer(ground.skid),
        np.frombuffer(ground.rule, np.int8),
        np.frombuffer(ground.reward),
        is_exit.ravel(),
        ends,
        ends | is_exit.ravel(),
        _squared_distance(is_exit).ravel() if exit_cells and shaped else None,
        _build_draws(ground.random, is_exit.size),
    )


def _squared_distance(exits: NDArray[np.bool_]) -> NDArray[np.int64]:
    """Return each cell's squared distance to the nearest exit, whole numbers and so exact.

    First along the columns, then along the rows: as fast for many exits as for one.
    """
    height, width = exits.shape
    far = 4 * (height + width)
    vertical = np.where(exits, 0, far).astype(np.int64)
    for y in range(1, height):
        vertical[y] = np.minimum(vertical[y], vertical[y - 1] + 1)
    for y in range(height - 2, -1, -1):
        vertical[y] = np.minimum(vertical[y], vertical[y + 1] + 1)
    return _least_with_distance(vertical**2)


def _least_with_distance(values: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return, for each x of each row, the least of all `values[row, q] + (x - q)²`.

    The first best q never falls from one x to a greater one, so it is looked for only between
    those of two neighbours that are known: far apart at first, then halfway between them.
    """
    rows, width = values.shape
    best, nearest = np.zeros_like(values), np.empty_like(values)
    first = np.arange(rows)[:, None] * width
    step = 1 << (width.bit_length() - 1)
    while step:
        x = np.arange(step - 1, width, 2 * step)
        low, high = np.zeros((rows, x.size), np.int64), np.full((rows, x.size), width - 1)
        low[:, 1:] = best[:, x[1:] - step]
        is_known = x + step < width
        high[:, is_known] = best[:, (x + step)[is_known]]
        # All that is looked at, one after another, by its place in the flat array.
        length = (high - low + 1).ravel()
        begin = np.cumsum(length) - length
        place = np.arange(length.sum()) + np.repeat((first + low).ravel() - begin, length)
        distance = place - np.repeat((first + x).ravel(), length)
        told = (values.ravel()[place] + distance**2) * width + place % width
        least = np.minimum.reduceat(told, begin).reshape(rows, x.size)
        nearest[:, x], best[:, x] = np.divmod(least, width)
        step //= 2
    return nearest


States = NDArray[np.int32]

WIND = 200
"""The steps of work to find for a cell where the wind takes the robot."""

NORTH, EAST, SOUTH, WEST = range(NUM_MOVES)
BACK = (SOUTH, WEST, NORTH, EAST)
"""The opposite of each direction."""

VERTICAL = (True, False, True, False)
SIGN = (-1, 1, 1, -1)
"""The direction of each move on its axis: south and east are positive."""


@dataclass(frozen=True, eq=False)
class Moves:
    """Arrays `[moves, states]`, one row a move: north, east, south, west, and the diagonal ones.

    Where there are boxes, a state is a pair of configuration and cell.

    Attributes:
        here: `[states]`: the cell of each state.
        open: whether nothing closes that side of the cell, and of a diagonal move, either way
            around the corner. Walls of glass do.
        landing: where a robot comes to stand that tries the direction; glass is a wall to it.
        refused: whether a wall refused the move: it pushed against the side and did not go.
        glass: the probability of getting through the wall of glass that the move tries, else 0.
        through: where the robot comes to stand if it gets through; without glass of no meaning.
        bounce: where it comes to stand if it bounces off.
        pushed: which box comes along to the landing, as `happened` of `Branches` tells it.
        through_pushed: the same for a robot that gets through glass.
        bounce_pushed: and for one that bounces off.
    """

    here: States
    open: Flags
    landing: States
    refused: Flags
    glass: NDArray[np.float64]
    through: States
    bounce: States
    pushed: NDArray[np.int8]
    through_pushed: NDArray[np.int8]
    bounce_pushed: NDArray[np.int8]

    @property
    def num_actions(self) -> int:
        """The number of actions: the moves, and to stay."""
        return len(self.open) + 1


@dataclass(frozen=True, eq=False)
class Air:
    """What moves come to in each wind that may blow in a step, that as given first.

    Attributes:
        moves: the moves in each wind.
        chances: how likely each wind is.
        windy: `[states]`: whether the wind makes a difference to moves.
    """

    moves: tuple[Moves, ...]
    chances: tuple[float, ...]
    windy: Flags

    @property
    def given(self) -> Moves:
        """The moves in the wind as given."""
        return self.moves[0]


def build_air(level: LevelFields, grid: Grid) -> Air:
    """Walk every direction out of every cell in each wind."""
    winds = gusts(level.wind)
    moves = tuple(build_moves(level, grid, stronger) for _, stronger in winds)
    return Air(moves, tuple(chance for chance, _ in winds), windy_cells(level, grid))


def windy_cells(level: LevelFields, grid: Grid) -> Flags:
    """Return where the wind pushes, `[cells]`."""
    south, east = shifts(level.wind, grid.width, grid.height)
    windy: Flags = (np.array(east) != 0)[:, None] | (np.array(south) != 0)
    return windy.ravel()


def build_moves(level: LevelFields, grid: Grid, stronger: int | None = 0) -> Moves:
    """Walk every direction out of every cell; for `stronger` see `shifts`."""
    count = grid.width * grid.height
    states = np.arange(count, dtype=np.int32)
    open_ = np.ascontiguousarray(grid.open.reshape(count, NUM_MOVES).T)
    shift = [dx + grid.width * dy for dx, dy in list(DELTAS.values())[: level.moves]]
    delta = np.array(shift, np.int32)[:, None]
    step = np.where(open_, states + delta[:NUM_MOVES], states)
    if level.moves > NUM_MOVES:
        open_ = np.concatenate([open_, _open_corners(open_, step)])
        step = np.where(open_, states + delta, states)
    # Where there is none, it takes no room.
    glass = np.zeros(step.shape) if grid.glass else np.broadcast_to(0.0, step.shape)
    for (cell, side), probability in grid.glass.items():
        glass[SIDES.index(side), cell] = probability
    bounce = step[[*BACK, *range(NUM_MOVES, level.moves)]] if grid.glass else step
    unpushed = np.broadcast_to(np.int8(0), step.shape)
    if level.wind is None:
        through = np.where(glass > 0, states + delta, states) if grid.glass else step
        return Moves(states, open_, step, ~open_, glass, through, bounce, *[unpushed] * 3)

    budget.spend(WIND * count)
    south, east = shifts(level.wind, grid.width, grid.height, stronger)
    pushes = {
        True: np.tile(np.array(south, np.int32), grid.height),
        False: np.repeat(np.array(east, np.int32), grid.width),
    }
    landing = np.empty_like(step)
    through = np.empty_like(step) if grid.glass else landing
    refused = np.empty_like(open_)

    free = _free_runs(open_[:NUM_MOVES], grid)

    def walk(start: States, amount: States, vertical: bool) -> States:
        """Walk `amount` cells along an axis, each state until a wall stops it."""
        ahead, back = (SOUTH, NORTH) if vertical else (EAST, WEST)
        forth = np.minimum(amount, free[ahead, start])
        taken = np.where(amount > 0, forth, -np.minimum(-amount, free[back, start]))
        ends: States = start + taken * delta[ahead]
        return ends

    for way in range(NUM_MOVES):
        vertical, sign = VERTICAL[way], SIGN[way]
        along, across = pushes[vertical] + sign, pushes[not vertical]
        pushing = along * sign > 0
        landing[way] = walk(walk(states, along, vertical), across, not vertical)
        refused[way] = pushing & ~open_[way]
        if not grid.glass:
            continue
        glass[way] *= pushing
        behind = np.where(glass[way] > 0, states + delta[way], states)
        rest = np.where(glass[way] > 0, along - sign, 0)
        drift = np.where(glass[way] > 0, across, 0)
        through[way] = walk(walk(behind, rest, vertical), drift, not vertical)
    if level.moves > NUM_MOVES:
        diagonal = slice(NUM_MOVES, None)
        for ends in (landing, through):
            blown = walk(step[diagonal], pushes[True], vertical=True)
            ends[diagonal] = walk(blown, pushes[False], vertical=False)
        refused[diagonal] = ~open_[diagonal]
    return Moves(states, open_, landing, refused, glass, through, bounce, *[unpushed] * 3)


def _open_corners(open_: Flags, step: States) -> Flags:
    """Return, `[4, states]`, whether both ways around the corner of each diagonal move are open."""
    pairs = ((NORTH, EAST), (SOUTH, EAST), (SOUTH, WEST), (NORTH, WEST))
    return np.array(
        [
            open_[one] & open_[other] & open_[other, step[one]] & open_[one, step[other]]
            for one, other in pairs
        ]
    )


def _free_runs(open_: Flags, grid: Grid) -> States:
    """Return, `[4, states]`, how many cells one can go in each direction until a wall."""
    runs = np.zeros((NUM_MOVES, grid.height, grid.width), np.int32)
    for way, (is_open, run) in enumerate(zip(open_.reshape(runs.shape), runs, strict=True)):
        # Lines across the way, from the one where the grid ends.
        across, along = (is_open, run) if VERTICAL[way] else (is_open.T, run.T)
        if SIGN[way] > 0:
            across, along = across[::-1], along[::-1]
        for number in range(1, len(along)):
            along[number] = np.where(across[number], along[number - 1] + 1, 0)
    return runs.reshape(open_.shape)


class Lot(NamedTuple):
    """What chance decides: one of some landings, each with its weight."""

    landings: Ints
    weights: Floats


@dataclass(frozen=True, eq=False)
class Warps:
    """Where warps lead. A landing is a cell, or a way of warps to one: numbers beyond the cells.

    Attributes:
        arrive: `[landings]`: the cell in which a robot stands that would come to stand there;
            below 0, `-1 - arrive` is the number of the lot that decides.
        reward: `[landings]`: the reward of that step, nan where the warps give none.
        sends: `[landings]`: whether a warp sends the robot.
        leave: `[states]`: the landing of the moves that a warp sends away.
        chance: `[states]`: the probability with which it does, 0 without such a warp.
        lots: what chance decides; the first is which of the starts it is.
        cells: the number of cells.
    """

    arrive: States
    reward: Floats
    sends: Flags
    leave: States
    chance: Floats
    lots: tuple[Lot, ...]
    cells: int

    @cached_property
    def leaves(self) -> Flags:
        """Whether every move out of each state is a warp."""
        leaves: Flags = self.chance == 1
        return leaves

    @cached_property
    def pay(self) -> bool:
        """Whether any warp gives a reward."""
        return not np.isnan(self.reward).all()

    @cached_property
    def _rows(self) -> dict[tuple[int, ...], int]:
        """The sets of cells to which lots lead, numbered: the starts first."""
        return {row: n for n, row in enumerate(dict.fromkeys(map(self._cells_of, self.lots)))}

    def _cells_of(self, lot: Lot) -> tuple[int, ...]:
        return tuple(np.unique(self.arrive[lot.landings]).tolist())

    @property
    def drawn(self) -> Ints:
        """The cells of which chance decides on one: see `Mdp`."""
        found = [row * self.cells + cell for cells, row in self._rows.items() for cell in cells]
        return np.array(found, np.int64)

    @property
    def row_of_lot(self) -> Ints:
        """The number of the set of cells to which each lot leads."""
        return np.array([self._rows[self._cells_of(lot)] for lot in self.lots])

    def left_from(self, cell: Ints) -> Warps:
        """Return the warps of states that begin in some cells."""
        return replace(self, leave=self.leave[cell], chance=self.chance[cell])


End = tuple[int, float | None, bool]
"""Where a way ends: the cell, the reward of the warps on it, and whether a warp sends there."""

Ends = tuple[dict[End, float], float]
"""The ends of a way, each with its weight, and the sum of these."""

WARP, END = 4_000, 20
"""The steps of work to follow a warp, and for each of its ends."""


class _Ways:
    """Follows warps to their ends: one that leads onto another goes on from there."""

    def __init__(self, level: LevelFields, grid: Grid):
        self._level, self._grid = level, grid
        self._enter = {_state(warp.at, grid): warp for warp in level.warps if warp.when == "enter"}
        self._found: dict[int, Ends] = {}

    def of(self, warp: Warp) -> Ends:
        """Return where a warp leads, if it acts."""
        leads = self._level.leads_of(warp)
        found: dict[End, float] = {}
        total = float(sum(weight for _, weight in leads))
        for cell, count in leads:
            weight = float(count)
            ends, among = self.from_cell(_state(cell, self._grid))
            if len(leads) == 1:
                # As it stands, so that equal weights stay exact.
                weight, among, total = 1.0, 1.0, among
            for (end, reward, _), share in ends.items():
                key = end, reward if warp.reward is None else warp.reward, True
                found[key] = found.get(key, 0.0) + weight * share / among
        budget.spend(WARP + END * len(found))
        check_room(self._level, self._grid.width * self._grid.height, len(found))
        return found, total

    def from_cell(self, cell: int) -> Ends:
        """Return where a robot ends that would come to stand on a cell."""
        waiting = [] if cell in self._found else [cell]
        while waiting:
            # The fields were checked: no chain is a circle.
            warp = self._enter.get(waiting[-1])
            leads = () if warp is None else self._level.targets_of(warp)
            ahead = [to for at in leads if (to := _state(at, self._grid)) not in self._found]
            if ahead:
                waiting += ahead
            else:
                here = waiting.pop()
                self._found[here] = self._ends(here, warp)
        return self._found[cell]

    def _ends(self, here: int, warp: Warp | None) -> Ends:
        remains: dict[End, float] = {(here, None, False): 1.0}
        if warp is None:
            return remains, 1.0
        ends, total = self.of(warp)
        if warp.probability == 1:
            return ends, total
        sent = {end: warp.probability * share / total for end, share in ends.items()}
        rest = dict.fromkeys(remains, 1.0 - warp.probability)
        return {end: share for end, share in (sent | rest).items() if share > 0}, 1.0


def build_warps(level: LevelFields, grid: Grid) -> Warps:
    """Follow every warp to its ends."""
    count, ways = grid.width * grid.height, _Ways(level, grid)
    arrive, reward, sends = np.arange(count), np.full(count, np.nan), np.zeros(count, bool)
    more: list[End] = []
    starts = np.array([_state(cell, grid) for cell in level.starts])
    lots = [Lot(starts, np.array(level.weights_of_starts, float))]

    def added(end: End) -> int:
        """Add a landing that surely is an end."""
        more.append(end)
        return count + len(more) - 1

    def leads(ends: Ends) -> End:
        """Return where a landing leads that has several ends: below 0, to a lot."""
        (first, *others), weights = [*ends[0]], [*ends[0].values()]
        if not others:
            return first
        lots.append(Lot(np.array([added(end) for end in ends[0]]), np.array(weights)))
        return -len(lots), None, False

    for warp in level.warps:
        if warp.when == "enter":
            at = _state(warp.at, grid)
            arrive[at], paid, sends[at] = leads(ways.from_cell(at))
            reward[at] = np.nan if paid is None else paid
    leave, chance = np.arange(count, dtype=np.int32), np.zeros(count)
    for warp in level.warps:
        if warp.when == "leave":
            at = _state(warp.at, grid)
            leave[at], chance[at] = added(leads(ways.of(warp))), warp.probability
    paid_more = [np.nan if paid is None else paid for _, paid, _ in more]
    return Warps(
        arrive=np.append(arrive, [cell for cell, _, _ in more]).astype(np.int32),
        reward=np.append(reward, paid_more),
        sends=np.append(sends, [sent for _, _, sent in more]).astype(bool),
        leave=leave,
        chance=chance,
        lots=(*lots,),
        cells=count,
    )


def _state(cell: tuple[int, int], grid: Grid) -> int:
    return cell[1] * grid.width + cell[0]


def obstructions(
    air: Air, terrain: Terrain, warps: Warps
) -> tuple[NDArray[np.int8], NDArray[np.int32]]:
    """Return what hinders each action, and where it leads without chance.

    Below 0, `-1 - target` is the number of the set of cells to one of which it leads.
    """
    count, moves = terrain.over.size, air.given
    obstruction = np.full((count, moves.num_actions), FREE, np.int8)
    target = np.empty(obstruction.shape, np.int32)
    target[:, Action.STAY] = moves.here
    moves_on = (warps.chance == 0) & ~terrain.over
    # One way after the other: copies of all of them would need much room.
    for way in range(len(moves.open)):
        action, glass = way + 1, moves.glass[way] > 0
        # What one of the winds lets pass is worth a try.
        refused = np.logical_and.reduce([each.refused[way] for each in air.moves])
        obstruction[moves_on & refused, action] = REFUSED
        obstruction[moves_on & glass, action] = GLASS
        landing = np.where(glass, moves.through[way], moves.landing[way])
        target[:, action] = warps.arrive[np.where(warps.leaves, warps.leave, landing)]
    target[terrain.over] = moves.here[terrain.over, None]
    drawn = target < 0
    if drawn.any():
        target[drawn] = -1 - warps.row_of_lot[-1 - target[drawn]]
    return obstruction, target
