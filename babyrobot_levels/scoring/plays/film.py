"""Plays as films."""

from __future__ import annotations

from collections.abc import Callable

from babyrobot_levels.language.play import PlayError
from babyrobot_levels.mdp.actions import Action, Turn
from babyrobot_levels.mdp.events import Event, events_of
from babyrobot_levels.render.gif import Step
from babyrobot_levels.render.gif import to_gif as paint
from babyrobot_levels.scoring.plays.files import Play
from babyrobot_levels.scoring.plays.verify import verify_play


def to_gif(
    play: Play,
    *,
    scale: float | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> bytes:
    """Return a play as an animated GIF; a robot that turns is shown without its heading.

    Args:
        play: the play.
        scale: the size, where 1 is 64 pixels per cell; None for the largest up to 1 with which no
            side has more than 800 pixels.
        progress: told of the frames that are done.

    Raises:
        PlayError: the play is not valid.
        ValueError: the film is too large.
    """
    fault = verify_play(play).fault
    if fault is not None:
        raise PlayError(f"the play is not valid: {fault}")
    return paint(play.level, steps_of(play), scale=scale, progress=progress)


def steps_of(play: Play) -> list[Step]:
    """Return the steps of a valid play in the numbering of `level.compile()`."""
    mdp = play.level.compile()
    cells = mdp.cells
    if play.action_set == "turns":
        size = mdp.cells * 4
        states = [state // size * cells + state % cells for state in play.states]
        headings = [state // cells % 4 for state in play.states]
        actions = [
            headings[step] + Action.NORTH if action == Turn.FORWARD else Action.STAY
            for step, action in enumerate(play.actions)
        ]
    else:
        states = play.states
        first = Action.NORTH if play.action_set == "moves" else Action.STAY
        actions = [action + first for action in play.actions]
    steps = []
    for number, (action, reward) in enumerate(zip(actions, play.rewards, strict=True)):
        state, after = states[number], states[number + 1]
        is_it = (mdp.probability[state, action] > 0) & (mdp.next_state[state, action] == after)
        event = events_of(mdp, slice(state, state + 1))[0, action][is_it.argmax()]
        steps.append(Step(state, int(action), after, reward, bool(event == Event.SKIDDED)))
    return steps
