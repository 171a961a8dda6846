"""Levels as arrays that compiled code changes: mutants, and their tables, without Python.

What the tables depend on is in the arrays of `Layout`; all else (rewards, what puddles are, areas,
blocked cells, limits) is that of one base level. `Designs.level` makes files of them again.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial, reduce
from typing import Any, Unpack

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array, lax
from jax.tree_util import register_dataclass
from numpy.typing import NDArray

from babyrobot_levels.analysis.solver.results import check_count
from babyrobot_levels.envs.arguments import ObservationOptions, takes_observation
from babyrobot_levels.envs.observations.planes import plane_names, squashed
from babyrobot_levels.generation.edits import Fields, changed, flat_fields
from babyrobot_levels.jax.env import LevelEnvironment, make
from babyrobot_levels.jax.observations import Counts, PlaneTables, Room, RowTable
from babyrobot_levels.jax.outcomes import WIDTH, merged
from babyrobot_levels.jax.params import NEVER, TERMINAL, EnvParams
from babyrobot_levels.language.base import SIDE_NAMES
from babyrobot_levels.language.cells import PRECEDENCE, Puddle
from babyrobot_levels.library.catalogue import load
from babyrobot_levels.library.level import Level
from babyrobot_levels.mdp.actions import NUM_MOVES
from babyrobot_levels.mdp.compiler.terrain import build_terrain
from babyrobot_levels.mdp.drawn import Edge, Traits, wall_entries
from babyrobot_levels.mdp.ground import OPEN_RULE, OTHERS_RULE, SIDES_RULE, build_ground
from babyrobot_levels.text.words import check_choice

OBSERVED = ("index", "position", "planes")
"""The observations whose tables are made in compiled code."""

KINDS = ("wall", "puddle", "start", "exit")
_PUDDLES = ("small", "large")


@register_dataclass
@dataclass(frozen=True)
class Layout:
    """A level as arrays, or several along a first axis.

    Attributes:
        walls: bool `[2, height, width]`: whether a wall is east of a cell, and south of it. At the
            edge of the grid and beside blocked cells it has no meaning.
        puddles: int8 `[height, width]`: 0 for none, 1 for a small and 2 for a large one.
        start: int32: the cell of the start, `y * width + x`.
        exit: int32: the cell of the exit.
    """

    walls: Array
    puddles: Array
    start: Array
    exit: Array


@takes_observation
def designs(
    level: Any, count: int, *, actions: str = "moves", **options: Unpack[ObservationOptions]
) -> tuple[LevelEnvironment, Designs]:
    """Return an environment for levels that compiled code makes, and what makes them.

    Args:
        level: the level that says all but walls, puddles, start and exit: a name, a path, a mapping
            or a `Level`. It has one start and one exit, no diagonal moves, and no
            things, glass, wind or warps.
        count: how many levels there are at a time.
        actions: `"moves"` or `"all"`, as in `make`.
        options: `observation`, one of `"index"`, `"position"` and `"planes"`, and the options of
            planes.

    Returns:
        The environment, whose `load` takes files of as many levels, and the `Designs`.

    Raises:
        LevelNotFoundError: there is no such level.
        LevelError: the level is not valid.
        ValueError: it has something else, or another argument has an invalid value.
    """
    base = load(level)
    _check(base)
    check_choice("actions", actions, ("moves", "all"))
    check_count("count", count)
    env, params = make(base, actions=actions, **options)
    observation = env._loader.observation
    check_choice("observation", observation.name, OBSERVED)
    cells = base.width * base.height
    most = Counts(cells, cells * 4, 1, int(isinstance(params.observations, PlaneTables)))
    room = Room(count, Counts(*(count * each for each in most)), most, WIDTH)
    made = Designs(base, count, params, room, env)
    first = jax.tree.map(
        lambda array: jnp.broadcast_to(array, (count, *array.shape)), made.layout(base)
    )
    return LevelEnvironment(made.params(first), env._loader, room, f"{count:,} designs"), made


class Designs:
    """Makes tables of layouts, layouts of levels, and levels of layouts; see `designs`.

    `params`, `mutate` and `is_solvable` are pure functions of arrays, to be compiled.
    """

    def __init__(
        self, base: Level, count: int, params: EnvParams, room: Room, env: LevelEnvironment
    ) -> None:
        self.base, self.count = base, count
        self._params, self._room = params, room
        self._fields = flat_fields(base)
        self._first_action = env._loader.actions.first
        self._observation, self._extent = env._loader.observation, env._loader.extent
        grounds = [build_terrain(self._flooded(size), base.grid()) for size in (None, *_PUDDLES)]
        skid = np.stack([ground.skid for ground in grounds])
        self._skid, self._rule = skid, np.stack([ground.rule for ground in grounds])
        # Divided here, so that compilers do not round in other ways.
        self._share = np.stack([skid, *(skid / count for count in (1, 2, 3))])
        self._reward = np.stack([ground.reward for ground in grounds])
        self._blocked = base.grid().blocked.ravel()
        self._ends = grounds[0].ends
        self._cells = np.arange(self._ends.size, dtype=np.int32)
        self._sides = _sides(~self._blocked.reshape(base.height, base.width))
        self._rewards = base.rewards

    def _flooded(self, size: str | None) -> Level:
        """Return the base with the same puddle in all cells, which is not checked."""
        cells = [(x, y) for y in range(self.base.height) for x in range(self.base.width)]
        puddles = [Puddle.model_validate({"at": cell, "size": size}) for cell in cells if size]
        return self.base.model_copy(update={"puddles": tuple(puddles)})

    # -- files -----------------------------------------------------------------------------

    def layout(self, level: Any) -> Layout:
        """Return a level as arrays.

        Args:
            level: a name, a path, a mapping or a `Level`.

        Raises:
            LevelNotFoundError: there is no such level.
            LevelError: the level is not valid.
            ValueError: it differs from the base in more than walls, puddles, start and exit.
        """
        given = load(level)
        _check(given)
        if self._others(flat_fields(given)) != self._others(self._fields):
            raise ValueError(f"{given!r} differs from the base in more than walls and puddles")
        width, bits = given.width, np.frombuffer(given.grid().wall_bits, np.uint8)
        bits = bits.reshape(given.height, width)
        puddles = np.zeros(bits.shape, np.int8)
        for puddle in given.puddles:
            x, y = puddle.at
            puddles[y, x] = max(puddles[y, x], 1 + _PUDDLES.index(puddle.size))
        ends = (cell[1] * width + cell[0] for cell in (given.starts[0], given.exits[0]))
        start, exit_ = map(jnp.int32, ends)
        walls = jnp.asarray(np.stack([bits & 2, bits & 4]) > 0) & self._sides
        return Layout(walls, jnp.asarray(puddles), start, exit_)

    def level(self, layout: Layout, name: str | None = None) -> Level:
        """Return arrays as a level, to be saved.

        Args:
            layout: one level.
            name: its name.

        Raises:
            LevelError: it is not valid: a start on the exit, or on a blocked cell.
        """
        width = self.base.width
        edges: dict[Edge, Traits] = {
            (side, int(x), int(y)): {}
            for side, walls in zip("ES", np.asarray(layout.walls) & self._sides, strict=True)
            for y, x in zip(*np.nonzero(walls), strict=True)
        }
        puddles = np.asarray(layout.puddles)
        wet = [
            {"at": [int(x), int(y)], "size": _PUDDLES[puddles[y, x] - 1]}
            for y, x in zip(*np.nonzero(puddles), strict=True)
        ]
        ends = {
            field: [*divmod(int(cell), width)][::-1]
            for field, cell in (("start", layout.start), ("exit", layout.exit))
        }
        fields = {"walls": [*wall_entries(edges)], "puddles": wet, **ends}
        return Level.from_fields(changed(self._fields, fields), name=name)

    @staticmethod
    def _others(fields: Fields) -> Fields:
        own = ("walls", "puddles", "start", "exit")
        return {name: value for name, value in fields.items() if name not in own}

    # -- edits -----------------------------------------------------------------------------

    @partial(jax.jit, static_argnames=("self", "kinds", "solvable"))
    def mutate(
        self,
        key: Array,
        layout: Layout,
        edits: Any = 1,
        *,
        kinds: Sequence[str] = KINDS,
        solvable: bool = True,
    ) -> Layout:
        """Return a layout with random edits.

        An edit builds or removes a wall, makes a puddle another one or none, or moves the start to
        a free cell, or the exit to one that is dry, too. What cannot be edited stays.

        Args:
            key: the source of randomness.
            layout: one level.
            edits: how many edits, int32, which may be traced.
            kinds: which of `"wall"`, `"puddle"`, `"start"` and `"exit"` are edited, equally often.
            solvable: whether an edit is left out after which there is no path to the exit.
        """
        for kind in kinds:
            check_choice("kinds", kind, KINDS)
        branches = [getattr(self, f"_edit_{kind}") for kind in kinds]

        def edit(number: Array, now: Layout) -> Layout:
            which, how = jax.random.split(jax.random.fold_in(key, number))
            kind = jax.random.randint(which, (), 0, len(branches))
            new: Layout = lax.switch(kind, branches, how, now)
            if not solvable:
                return new
            is_kept = self.is_solvable(new)
            kept: Layout = jax.tree.map(partial(jnp.where, is_kept), new, now)
            return kept

        edited: Layout = lax.fori_loop(0, edits, edit, layout)
        return edited

    def _edit_wall(self, key: Array, layout: Layout) -> Layout:
        sides = np.flatnonzero(self._sides)
        if not sides.size:
            return layout
        flat = layout.walls.reshape(-1)
        side = jax.random.choice(key, sides)
        return replace(layout, walls=flat.at[side].set(~flat[side]).reshape(layout.walls.shape))

    def _edit_puddle(self, key: Array, layout: Layout) -> Layout:
        where, what = jax.random.split(key)
        flat = layout.puddles.reshape(-1)
        cell = self._free_cell(where, self._cells != layout.exit, layout.start)
        new = (flat[cell] + jax.random.randint(what, (), 1, 3, jnp.int8)) % 3
        return replace(layout, puddles=flat.at[cell].set(new).reshape(layout.puddles.shape))

    def _edit_start(self, key: Array, layout: Layout) -> Layout:
        is_free = (self._cells != layout.start) & (self._cells != layout.exit)
        return replace(layout, start=self._free_cell(key, is_free, layout.start))

    def _edit_exit(self, key: Array, layout: Layout) -> Layout:
        # A puddle has no effect on an exit.
        is_free = (self._cells != layout.start) & (self._cells != layout.exit)
        is_free &= layout.puddles.reshape(-1) == 0
        return replace(layout, exit=self._free_cell(key, is_free, layout.exit))

    def _free_cell(self, key: Array, is_free: Array, now: Array) -> Array:
        """Draw one of some cells that does not end the episode; without one, return that of now."""
        is_free &= ~self._ends
        drawn = jax.random.choice(key, self._cells, p=is_free / jnp.maximum(is_free.sum(), 1))
        return jnp.where(is_free.any(), drawn, now)

    @partial(jax.jit, static_argnames=("self",))
    def is_solvable(self, layout: Layout) -> Array:
        """Return whether a path leads from the start to the exit, bool.

        Where all steps cost something and no area ends the episode, the optimal policy then surely
        reaches it.
        """
        _, landing = self._moves(layout)
        goes_on = ~self._ends

        def spread(carry: tuple[Array, Array]) -> tuple[Array, Array]:
            seen, _ = carry
            more = seen | reduce(jnp.logical_or, (seen[to] for to in landing))
            more &= goes_on
            return more, (more & ~seen).any()

        begin = jnp.zeros(goes_on.size, bool).at[layout.start].set(True)
        seen, _ = lax.while_loop(lambda carry: carry[1], spread, (begin, jnp.bool_(True)))
        return seen[layout.exit]

    # -- tables ----------------------------------------------------------------------------

    def _moves(self, layout: Layout) -> tuple[Array, Array]:
        """Return which sides of cells are open, bool `[4, cells]`, and where moves lead, int32."""
        width, height = self.base.size
        east, south = ~layout.walls & self._sides
        sides = jnp.stack([jnp.roll(south, 1, axis=0), east, south, jnp.roll(east, 1, axis=1)])
        open_ = sides.reshape(4, -1)
        step = np.array([-width, 1, width, -1], np.int32)[:, None]
        cells = jnp.arange(width * height, dtype=jnp.int32)
        return open_, jnp.where(open_, cells + step, cells)

    @partial(jax.jit, static_argnames=("self",))
    def params(self, layouts: Layout) -> EnvParams:
        """Return the tables of levels: those of the files of these levels, bit for bit in x64.

        Args:
            layouts: as many levels as the environment has, along the first axis. If a level is not
                valid, its tables have no meaning.

        Raises:
            ValueError: there are more or fewer.
        """
        count, cells = self.count, self._ends.size
        if layouts.start.shape != (count,):
            raise ValueError(f"there must be {count:,} levels, not {list(layouts.start.shape)}")
        found = jax.vmap(self._tables)(layouts)
        actions, states = self._params.num_actions, count * cells
        base = (jnp.arange(count, dtype=jnp.int32) * cells)[:, None, None, None]
        floats = self._params.reward.dtype
        entries = {
            "next_state": (found["next_state"] + base).reshape(-1, WIDTH),
            "reward": found["reward"].astype(floats).reshape(-1, WIDTH),
            "outcome": found["outcome"].reshape(-1, WIDTH),
        }
        is_drawn = found["is_drawn"].reshape(-1)
        number = jnp.cumsum(is_drawn, dtype=jnp.int32) - 1
        room = self._room.total.branches
        place = jnp.where(is_drawn, number, room)

        def branches(values: Array, unused: Any) -> Array:
            empty = jnp.full((room, *values.shape[1:]), unused, values.dtype)
            return empty.at[place].set(values, mode="drop")

        first = {name: values[:, 0] for name, values in entries.items()}
        first["next_state"] = jnp.where(is_drawn, -1 - number, first["next_state"])
        unused = {"next_state": 0, "reward": 0, "outcome": TERMINAL}
        drawn = {name: branches(entries[name], unused[name]).reshape(-1) for name in entries}
        counts = is_drawn.reshape(count, -1).sum(axis=1, dtype=jnp.int32)
        offset = jnp.arange(count + 1, dtype=jnp.int32) * cells
        once = jnp.arange(count + 1, dtype=jnp.int32)
        chances = found["probability"].reshape(-1, WIDTH).astype(floats)
        return replace(
            self._params,
            **{name: jnp.concatenate([first[name], drawn[name]]) for name in entries},
            threshold=branches(found["threshold"].reshape(-1, WIDTH - 1), NEVER),
            probability=branches(chances, 0),
            mask=found["mask"].reshape(-1),
            held=jnp.zeros((states, self._params.held.shape[-1]), bool),
            offset=offset,
            first_branch=jnp.concatenate([jnp.zeros(1, jnp.int32), jnp.cumsum(counts)]).astype(
                jnp.int32
            ),
            starts=offset[:-1] + layouts.start,
            first_start=once,
            limit=jnp.repeat(self._params.limit, count),
            discount=jnp.repeat(self._params.discount, count),
            number=once[:-1],
            observations=self._observations(layouts),
            num_actions=actions,
            most_outcomes=WIDTH,
            sizes=(self._room.most.states, self._room.most.branches, 1),
            draws_levels=count > 1,
            draws_outcomes=True,
        )

    def _tables(self, layout: Layout) -> dict[str, Array]:
        """Return the outcomes of all rows of a level, `[cells, actions, outcomes]`, and more."""
        cells = jnp.arange(self._ends.size, dtype=jnp.int32)
        open_, landing = self._moves(layout)
        ground = layout.puddles.reshape(-1).astype(jnp.int32)
        skid, rule, paid = (
            jnp.asarray(each)[ground, cells] for each in (self._skid, self._rule, self._reward)
        )
        shares = jnp.asarray(self._share)[:, ground, cells]
        is_exit = cells == layout.exit
        over = is_exit | self._ends
        slips = (skid > 0) & ~over
        rows = []
        for way in range(4):
            others = open_.sum(axis=0) - open_[way]
            is_open = rule == OPEN_RULE
            stuck = jnp.where(is_open & (others == 0), skid, 0)
            tried = [(way, 1.0 - skid), (None, stuck)]
            for turn in (1, 2, 3):
                other = (way + turn) % 4
                share = jnp.where(is_open & open_[other], shares[others, cells], 0)
                if turn != 2:
                    share = jnp.where(rule == SIDES_RULE, shares[2], share)
                tried.append((other, jnp.where(rule == OTHERS_RULE, shares[3], share)))
            is_sure = ~slips | (~open_[way] & is_open)
            branches = []
            for number, (taken, chance) in enumerate(tried):
                sure = jnp.where(is_sure, float(number == 0), chance)
                to = cells if taken is None else jnp.where(over, cells, landing[taken])
                bumps = jnp.zeros_like(over) if taken is None else ~open_[taken]
                branches.append((sure, to, self._pay(layout, to, paid, over, bumps=bumps)))
            intended = jnp.where(over, cells, landing[way])
            rows.append(merged(branches, over, layout.exit, intended, ~open_[way] & ~over))
        if not self._first_action:
            stays = self._pay(layout, cells, paid, over, stays=True)
            rows.insert(
                0, merged([(jnp.ones(cells.size), cells, stays)], over, layout.exit, cells, None)
            )
        mask = [~over & open_[way] for way in range(4)]
        if not self._first_action:
            mask.insert(0, jnp.ones_like(over))
        found = {name: jnp.stack([row[name] for row in rows], axis=1) for name in rows[0]}
        bits = sum(allowed.astype(jnp.uint8) << place for place, allowed in enumerate(mask))
        return {**found, "mask": jnp.asarray(bits)}

    def _pay(
        self,
        layout: Layout,
        to: Array,
        paid: Array,
        over: Array,
        *,
        bumps: Array | None = None,
        stays: bool = False,
    ) -> Array:
        """Return what steps from all cells pay that end on cells `to`."""
        rewards, width = self._rewards, self.base.width
        here = jnp.arange(to.size)

        def distance(cell: Array) -> Array:
            return (cell % width - layout.exit % width) ** 2 + (
                cell // width - layout.exit // width
            ) ** 2

        applies = {
            "exit": (to == layout.exit, rewards.exit),
            "stay": (jnp.full(to.shape, stays), rewards.stay),
            "bump": (jnp.zeros_like(over) if bumps is None else bumps, rewards.bump),
            "closer": (distance(to) < distance(here), rewards.closer),
            "farther": (distance(here) < distance(to), rewards.farther),
        }
        pay = paid[to]
        for name in reversed(PRECEDENCE):
            if name in applies and applies[name][1] is not None:
                pay = jnp.where(applies[name][0], applies[name][1], pay)
        return jnp.where(over, 0.0, pay)

    def _observations(self, layouts: Layout) -> RowTable | PlaneTables:
        tables, count = self._params.observations, self.count
        if isinstance(tables, RowTable):
            return replace(tables, rows=jnp.tile(tables.rows, (count, 1)[: tables.rows.ndim]))
        assert isinstance(tables, PlaneTables)
        number = jnp.arange(count, dtype=jnp.int32)
        return replace(
            tables,
            ground=jnp.repeat(number, self._ends.size),
            robot=jnp.tile(tables.robot, (count, 1)),
            grounds=jax.vmap(self._planes)(layouts),
            first_ground=jnp.arange(count + 1, dtype=jnp.int32),
        )

    def _planes(self, layout: Layout) -> Array:
        """Return the planes of a level without the robot."""
        (width, height), observation = self.base.size, self._observation
        cells = np.arange(width * height)
        ground = layout.puddles.reshape(-1).astype(jnp.int32)
        is_exit, is_free = cells == layout.exit, ~self._blocked
        paid = jnp.where(is_free, jnp.asarray(squashed(self._reward))[ground, cells], 0.5)
        open_ = self._moves(layout)[0]
        planes = {
            "start": cells == layout.start,
            "exit": is_exit,
            "blocked": self._blocked,
            "ends": self._ends & is_free,
            "skid": jnp.where(is_free, jnp.asarray(self._skid)[ground, cells], 0),
            "reward": jnp.where(is_exit, squashed(self._rewards.exit), paid),
            **{f"puddle-{size}": ground == code for code, size in enumerate(_PUDDLES, 1)},
            **{f"wall-{side}": ~each for side, each in zip(SIDE_NAMES, open_, strict=True)},
        }
        nothing = jnp.zeros(cells.size)
        stack = jnp.stack([planes.get(name, nothing) for name in plane_names(self._extent)])
        stack = stack.reshape(-1, height, width)
        if observation.channels_last:
            stack = jnp.moveaxis(stack, 0, -1)
        if observation.planes_dtype == "uint8":
            stack = jnp.rint(255 * stack)
        return stack.astype(observation.planes_dtype)


def _sides(is_free: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return between which cells walls matter, as in `Layout`: between two that are free."""
    sides = np.zeros((2, *is_free.shape), bool)
    sides[0, :, :-1] = is_free[:, :-1] & is_free[:, 1:]
    sides[1, :-1] = is_free[:-1] & is_free[1:]
    return sides


def _check(level: Level) -> None:
    """Check that a level has nothing but what tables are made of here.

    Raises:
        ValueError: it has more.
    """
    grid = level.grid()
    more = {
        "things": level.has_things,
        "diagonal moves": level.moves > NUM_MOVES,
        "wind": level.wind,
        "warps": level.warps,
        "glass": grid.glass,
        "several starts": len(level.starts) > 1,
        "several exits or none": len(level.exits) != 1,
        "an exit that pays what its cell does": isinstance(level.rewards.exit, str),
        "rewards that are drawn": build_ground(level).random,
    }
    if found := [name for name, there in more.items() if there]:
        raise ValueError(f"{level!r} has {found[0]}, of which no tables are made in compiled code")
