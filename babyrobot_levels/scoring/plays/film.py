"""Plays as the steps of films."""

from __future__ import annotations

from babyrobot_levels.mdp.actions import Action, Turn
from babyrobot_levels.mdp.events import Event, events_of
from babyrobot_levels.render.gif import Step
from babyrobot_levels.scoring.plays.files import Play


def steps_of(play: Play) -> list[Step]:
    """Return the steps of a valid play in the numbering of `level.compile()`.

    A robot that turns is shown without its heading.
    """
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
