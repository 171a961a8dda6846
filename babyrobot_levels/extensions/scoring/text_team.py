"""A level with several robots as a world of text: each agent reads what its own robot sees."""

from collections.abc import Mapping

from babyrobot_levels.envs.single import LevelEnv
from babyrobot_levels.envs.team import TeamEnv
from babyrobot_levels.extensions.scoring.graded import GradedEpisode
from babyrobot_levels.library.catalogue import LevelLike, load
from babyrobot_levels.library.level import Level
from babyrobot_levels.mdp.actions import MOVES, Action
from babyrobot_levels.render.sights import PICTURE
from babyrobot_levels.render.words.happenings import changes, moves_of_team
from babyrobot_levels.render.words.phrases import counted
from babyrobot_levels.text.words import listed

ACTIONS = {str(move): move for move in MOVES} | {"wait": Action.STAY}
"""What a robot can do, in words."""


class TextTeam(GradedEpisode, public=True):
    """A level with several robots, each of whose agents reads and writes.

    Each has what its own robot sees, by its name. All move at once, and each step is graded for the
    team, by the exact values of all joint actions. Grades are those of `TextWorld`, with the
    returns of the team. Where there are too many joint states for tables, returns are told, and
    `optimum`, `regret`, `luck` and advantages are nan.

    Attributes:
        level: the level.
        names: the names of the robots.
        within: the number of steps after which an episode is over.
        optimum: the optimal expected return of the team.
        done: whether the episode is over; True before the first `reset`.
        is_success: whether the robots have arrived that have to.
        invalid: how many moves could not be understood in this episode; these robots waited.
        seed: the seed of the episode.
    """

    def __init__(
        self,
        level: LevelLike,
        *,
        sight: str = "map",
        reward: str = "world",
        within: int | str | None = None,
        blunder: float = 0.1,
    ) -> None:
        """Make the world of a level with several robots.

        Args:
            level: a name, a path, a share code, a mapping or a `Level`.
            sight: what is seen, as for `TextWorld`.
            reward: what `reward` is, as for `TextWorld`.
            within: the number of steps after which an episode is over; by default `max_steps` of
                the level, which must have one then.
            blunder: as for `TextWorld`.

        Raises:
            LevelNotFoundError: there is no such level.
            LevelError: the level is not valid, or its maze has no seed yet.
            ValueError: another argument is invalid, the level has one robot, or is too large for
                its drawing.
            EpisodeTooLongError: there are too many states and steps to grade moves.
        """
        super().__init__(load(level), sight, reward, within, blunder)

    def reset(self, *, seed: int | None = None) -> dict[str, str]:
        """Start an episode.

        Args:
            seed: draws start and outcomes; another one each time if it is left out.

        Returns:
            For each robot the rules, and what it sees.
        """
        self._reset(seed)
        told = zip(self._stage.narrators, self.look().items(), strict=True)
        return {name: f"{narrator.rules()}\n\n{seen}" for narrator, (name, seen) in told}

    def step(self, moves: Mapping[str, str]) -> dict[str, str]:
        """Move all robots at once.

        Args:
            moves: for each robot north, east, south, west or wait. One without a move waits, and so
                does one whose move is another word, which is told.

        Returns:
            For each robot what happened, and what it sees now.
        """
        if self.done:
            self.invalid += 1
            return self.look()
        before, actions, notes = self.state, [], {}
        for name in self.names:
            word = str(moves.get(name, "wait")).strip().lower()
            actions.append(ACTIONS.get(word, Action.STAY))
            if word not in ACTIONS:
                self.invalid += 1
                notes[name] = f"That is no move: {listed([*ACTIONS], 'or')}. "
        env = self._env
        assert isinstance(env, TeamEnv)
        joint = env.action_number([int(action) for action in actions])
        self._take(joint, ", ".join(action.name.lower() for action in actions))
        return {
            name: "".join([notes.get(name, ""), self._happened(before, joint, number), "\n", seen])
            for number, (name, seen) in enumerate(self.look().items())
        }

    def look(self) -> dict[str, str]:
        """Look around; that takes no step.

        Returns:
            For each robot what it sees.
        """
        if self.done:
            return dict.fromkeys(self.names, self._over())
        scenes = (narrator.scene(self.state) for narrator in self._stage.narrators)
        return dict(zip(self.names, scenes, strict=True))

    def _make_env(self, level: Level) -> LevelEnv:
        if not level.robots:
            raise ValueError("the level has one robot: use `brl.TextWorld`")
        self.names = tuple(robot.name for robot in level.robots)
        return TeamEnv(level, observation="index", render_mode=self._render_mode)

    def _happened(self, before: int, joint: int, robot: int) -> str:
        """Return what a step has changed, as a robot is told it: moves of others if all is seen."""
        level, numbering = self.level, self.level.numbering()
        states = (before, self.state)
        then, now = (level.configuration(numbering.configuration(state)) for state in states)
        only = None if self._sight == "map" else robot
        moves = moves_of_team(level, before, joint, self.state, only=only)
        changed = changes(level, then, now, drawn=self._sight == PICTURE)
        return " ".join([*moves, *changed, self._count()])

    def _over(self) -> str:
        if not self._moves:
            return "There is no episode: reset the world to begin one."
        how = "for want of steps"
        if self._ended:
            how = "as they have arrived" if self.is_success else "before they have arrived"
        steps = counted(len(self._moves), "step")
        return f"The episode is over: it ended {how}, after {steps}, with {self.return_:g} in all."
