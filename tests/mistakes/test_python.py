"""Mistakes in Python: what each call raises, and what it says."""

from __future__ import annotations

import inspect
from collections.abc import Iterator
from typing import Any

import gymnasium
import numpy as np
import pytest

import babyrobot_levels as brl
from babyrobot_levels.text import words

SCOPE: dict[str, Any] = {"brl": brl, "gymnasium": gymnasium, "np": np}
MISTAKES = (
    ("brl.Suite('small-mazes')", "a suite is loaded by `brl.load_suite('small-mazes')`"),
    ("brl.compare('maze', 'FrozenLake-v1')", "did you mean 'gymnasium:FrozenLake-v1'?"),
    ("brl.solve('maze', gamma=0.9)", "argument 'gamma'; did you mean `discount`?"),
    ("brl.load('maze').solve(gamma=0.9)", "argument 'gamma'; did you mean `discount`?"),
    ("brl.solve('maze', max_steps=9)", "argument 'max_steps'; did you mean `within`?"),
    ("brl.load('maze', seed=3)", "did you mean `brl.load(level).with_maze_seed(number)`?"),
    ("brl.load(['maze', 'final-maze'])", "load each of several, and the map of another program"),
    (
        "brl.q_learning('maze', episodes='many')",
        "episodes must be a whole number, at least 1, not 'many'",
    ),
    ("brl.solve('maze', method='vi')", "did you mean `brl.value_iteration(level)`?"),
    ("brl.load('maze').V", "did you mean `brl.solve(level).values`?"),
    ("brl.load('maze').actions", "did you mean `brl.Action`?"),
    ("brl.load('maze').save('maze.png')", "saves the level as YAML, not maze.png: use to_png"),
    ("brl.load('maze').to_png('maze.svg')", "this makes PNG, not maze.svg: use to_svg"),
    ("brl.load_suite('small-mazes')['test']", "`suite.split('test')` has those of a split"),
    ("brl.check_plan('x', [1])", "scen must be a name, a path, a mapping or a Level, not [1]"),
    ("brl.export('maze', 'tiled', 'x.png')", "x.png is no file of the format tiled: use to_png"),
    ("brl.grade_values('maze', 0, tolerance=-1)", "tolerance must be 0 or more, not -1"),
    ("brl.make('maze', seed=1)", "each episode has its own: `env.reset(seed=1)`"),
    ("brl.value_iteration('maze', theta=1e-6)", "argument 'theta'; did you mean `tolerance`?"),
    ("brl.q_learning('maze', 9, alpha=0.1)", "argument 'alpha'; did you mean `step_size`?"),
    ("brl.q_learning('maze', num_episodes=9)", "'num_episodes'; did you mean `episodes`?"),
    ("brl.score('maze', 'random', gamma=0.9)", "argument 'gamma'; did you mean `discount`?"),
    ("brl.score('maze', 'random', view_radus=2)", "unexpected option 'view_radus'; did you mean"),
    ("brl.solve_many(['maze'], horizon=9)", "argument 'horizon'; did you mean `within`?"),
    ("brl.evaluate('maze', agent='random')", "argument 'agent'; did you mean `policy`?"),
    ("brl.rollout('maze', n_envs=2)", "argument 'n_envs'; did you mean `num_envs`?"),
    ("brl.make('maze', observation=[500, 500])", "observation='image', image_size=(500, 500)"),
    (
        "brl.make('maze').unwrapped.show_info({'text': [((70, 10), 'Baby Robot')]})",
        "which is not on the level; texts in a panel are lines: `side_panel`",
    ),
    ("brl.Level(size=[3, 3])", "a level begins with `version: 1`"),
    ("brl.Level(version=1, width=5)", "unknown field `width`; did you mean `size`?"),
    ("brl.Level(version=1, size=5)", "`size` must be `[width, height]`, not `5`"),
    ("brl.load('final_maze')", "no level called 'final_maze'; did you mean 'final-maze'"),
    ("brl.load('Final Maze')", "no level called 'Final Maze'; did you mean 'final-maze'"),
    ("brl.load('nothing.yaml')", "there is no file 'nothing.yaml'"),
    ("brl.load(3)", "a level is a name, a path, a mapping or a Level, not int"),
    ("brl.load({'size': [3, 3]})", "a level begins with `version: 1`"),
    ("brl.loads('maze.yaml')", "the file does not contain a mapping of fields"),
    ("brl.level('maze')", "has no attribute 'level'; did you mean `load`?"),
    ("brl.suite('small-mazes')", "has no attribute 'suite'; did you mean `load_suite`?"),
    ("brl.BabyRobotEnv()", "has no attribute 'BabyRobotEnv'; did you mean `make`?"),
    ("brl.train('maze')", "has no attribute 'train'; did you mean `q_learning`?"),
    ("brl.check('maze')", "has no attribute 'check'; did you mean `validate`?"),
    ("brl.make('maze', render_mode='ansii')", "not 'ansii'; did you mean `ansi`?"),
    ("brl.make('maze', observation='plane')", "not 'plane'; did you mean `planes`?"),
    ("brl.make('maze', obs='planes')", "argument 'obs'; did you mean `observation`?"),
    ("brl.make('maze', action='turns')", "argument 'action'; did you mean `actions`?"),
    ("brl.make('maze', actions='turn')", "not 'turn'; did you mean `turns`?"),
    ("brl.make('maze', is_slippery=False)", "the field `skid` of the level says"),
    ("brl.make('maze').step(0)", "call `reset()` before the first `step()`"),
    ("brl.load('maze').compile().cell('0')", "state must be 0 to 39, not '0'; that of the cell"),
    ("brl.load('maze').compile().outcomes(0, 'north')", "action must be 0 to 4, not 'north'"),
    ("brl.TextWorld('maze', 'map', 3)", "takes `level` without a name, all else by name: sight=…"),
    ("brl.load('maze').make('planes')", "make() takes all by name: name=…"),
    ("brl.LevelEnv('maze').reset(sed=5)", "argument 'sed'; did you mean `seed`?"),
    ("brl.replay('x.brlplay', 1)", "replay() takes only `plays`"),
    ("brl.parallel_env('two-pads').action_space('green')", "no agent 'green', but red and blue"),
    ("brl.load('maze').with_size(4, 4)", "did you mean `replace(…)`?"),
    ("brl.validate('maze').ok", "did you mean `not findings`?"),
    ("brl.preview('maze').save('x.png')", "did you mean `brl.preview(level, 'x.png')`?"),
    (
        "brl.simulate('maze', 'random', episodes=1.5)",
        "episodes must be a whole number, at least 1, not 1.5",
    ),
    (
        "brl.success_within('maze', 'best', steps='10')",
        "steps must be a whole number, at least 0, not '10'",
    ),
    ("brl.UniformSampler('maze')", "count must be a whole number, at least 1, not 'maze'"),
    ("brl.export('maze', to='tiled')", "argument 'to'; did you mean `format`?"),
    ("brl.RecordPlay(brl.load('maze'), 'x')", "records environments, as of `level.make()`"),
    ("gymnasium.make('babyrobot/Level-v0')", 'level="final-maze"'),
    ("gymnasium.make('babyrobot/Levl-v0')", "Did you mean: `Level`?"),
    (
        "gymnasium.make_vec('babyrobot/Level-v0', num_envs=0, level='maze')",
        "num_envs must be a whole number, at least 1, not 0",
    ),
    (
        "gymnasium.make_vec('babyrobot/Level-v0', num_envs=3, level='maze', engine='jax')",
        "engine must be one of 'numpy', 'compiled', not 'jax'",
    ),
    ("brl.solve('maze', discount=2)", "discount must be above 0 and at most 1, not 2"),
    ("brl.solve('maze', within=-1)", "a number of steps from 1 on, or 'max_steps', not -1"),
    ("brl.solve('random-maze')", "`level.with_maze_seed(n)` gives one of them"),
    ("brl.score('random', 'maze')", "the level comes first: `brl.score(levels, agent)`"),
    ("brl.evaluate(lambda seen: 0, 'maze')", "the level comes first: `brl.evaluate(level, pol"),
    ("brl.rollout(np.zeros((5, 8)), 'maze')", "the level comes first: `brl.rollout(level, pol"),
    ("brl.policy_table('a.npy', 'maze')", "the level comes first: `brl.policy_table(level, "),
    ("brl.score('maze', 'randm')", "no agent 'randm'; did you mean `random`"),
    ("brl.score('final-maze', np.zeros(3))", "an array [5, 8] of actions"),
    ("brl.rollout('maze', 'bst')", "no agent 'bst'; did you mean `best`"),
    ("brl.generate('small-maze', count=2)", "called 'small-maze'; did you mean 'small-mazes'?"),
    ("brl.generate(cout=2)", "argument 'cout'; did you mean `count`?"),
    ("brl.preview('maze', 'x.jpg')", "no format 'jpg', but svg, pdf, png, gif, html"),
    ("brl.load('maze').to_png(scale=-1)", "scale must be above 0 and at most 100, not -1"),
    ("brl.load('maze').to_svg(theme='night')", "known themes: default, babyrobot"),
    ("brl.load('maze').to_svg(values=[1, 2])", "`values` has the shape (2,)"),
    ("brl.load('maze').to_svg(policy='greedy')", "no agent 'greedy'; an agent is `best`"),
    ("brl.solve('maze', gama=0.9)", "argument 'gama'; did you mean `discount`?"),
    ("brl.score('maze', 'best', episode=3)", "argument 'episode'; did you mean `episodes`?"),
    ("brl.score('maze', 'best', workers=3)", "'workers'; there are observation, image_size,"),
    ("brl.load('maze')['size']", "is not subscriptable; did you mean `.size`?"),
    ("brl.evaluate('maze', 'best')['mean']", "did you mean `expected_return`?"),
    ("brl.metrics('maze')['difficulty']", "did you mean `.difficulty`?"),
    ("brl.q_learning('maze', 9, epsilon='high')", "epsilon must be from 0 to 1, not 'high'"),
    ("brl.q_learning('maze', 9, step_size=2)", "step_size must be above 0 and at most 1, not 2"),
    ("brl.preview('maze', 'picture')", "has no suffix that tells the format: svg, pdf, png,"),
    ("brl.load('maze').to_png('x.png', cell='big')", "'cell'; there are level, path, values,"),
    ("brl.load('maze').replace(size='4x4')", "write `size: [4, 4]`"),
    ("brl.generate(count=2, difficulty='3-5')", "write `difficulty: 3..5`"),
    ("brl.generate(count=2, metrics={'difficulty': 3})", "each metric is a field of its own"),
    ("brl.load_suite('small-mazes').split('trian')", "did you mean `train`?"),
    ("brl.load({'version': 1, 'switches': [{True: True}]})", "YAML 1.1 reads `on`, `off`,"),
    ("brl.Action('up')", "there is no action 'up'; did you mean `north`?"),
    ("brl.Action(9)", "no action 9; there are stay, north, east, south, west"),
    ("brl.preview('maze', values='best')", "`brl.evaluate(level, policy)` has those of a policy"),
    ("brl.load('maze').with_maze_seed('x')", "must be an integer, not 'x'"),
    ("brl.q_learning('maze', 9, 0.1)", "takes `level` and `episodes` without a name, all else"),
    ("brl.LevelVectorEnv('maze', 8)", "LevelVectorEnv() takes `level` without a name, all"),
    ("brl.make('maze', 'planes')", "make() takes `level` without a name, all else by name"),
    ("brl.LevelVectorEnv('maze', num_env=8)", "LevelVectorEnv() got an unexpected keyword"),
    ("gymnasium.make('babyrobot/maze-v0', agent_view_size=7)", "use `view_radius`, the cells on"),
    ("brl.LevelVectorEnv('maze', view_size=7)", "did you mean `view_radius`?"),
    ("brl.load('maze').configuration(99)", "there is no configuration 99: there are 1"),
    ("setattr(brl.load('maze'), 'size', [3, 3])", "levels do not change: `level.replace(…)`"),
    ("brl.jax", "`import babyrobot_levels.jax as brl_jax`"),
    ("brl.SuiteEnv('small-mazes')", "`gymnasium.make('babyrobot/Suite-v0', suite=…)`"),
    ("brl.TeamEnv('two-pads', actions='turns')", "'actions'; there are level, observation,"),
    ("gymnasium.make('babyrobot/two-pads-v0', rewards='own')", "`brl.parallel_env(level, rewards"),
    ("brl.load('maze').save(3)", "path must be a text or a path, not 3"),
    ("brl.load('maze').to_png('x.png', scale='2')", "scale must be a number or None, not '2'"),
    ("brl.share('maze', link=True)", "link must be a text or None, not True"),
    ("brl.preview('maze', 3)", "path must be a path or None, not 3"),
    ("brl.rule(501)", "code must be a text or None, not 501"),
    ("brl.metrics_many('maze', jobs='two')", "jobs must be a whole number or None, not 'two'"),
    ("brl.strip(3)", "pictures must be several in a list, not 3"),
    ("brl.summary(3)", "runs must be a Scores or several in a list, not 3"),
    ("brl.replay(3)", "plays must be a path, a Play or several in a list, not 3"),
    ("brl.solve(['maze', 'two-pads'])", "takes one level; `brl.solve_many(levels)` takes several"),
    ("brl.LevelVectorEnv(['maze', 3])", "takes one level, or several as `levels=…`"),
    ("brl.install('nosuchzoo')", "there is no file or folder nosuchzoo"),
    ("brl.grade('nosuch')", "there is no file or folder nosuch"),
    ("brl.load('maze').replace({'size': [3, 3]})", "of a mapping, replace(**mapping)"),
    ("brl.Action['up']", "did you mean `NORTH`?"),
    ("brl.Action['mro']", "has no attribute 'mro'"),
    ("brl.solve('maze').at(9, 9)", "`.values[y, x]` has the value of a cell"),
    ("brl.solve('maze').save('x.npy')", "did you mean `np.save(path, solution.policy)`?"),
    ("brl.load_suite('small-mazes').levels", "did you mean `[*suite]`?"),
    ("brl.score('maze', 'best')['maze']", "rows have numbers, 0 to 0, and no names: 'maze'"),
    ("brl.evaluate('maze', {(0, 0): 1})", ": a mapping has one for each level"),
    ("brl.evaluate('maze', lambda: 1)", "with the observation alone, and this one takes ()"),
    ("brl.mutate('maze', seed=1, kinds='walls')", "did you mean `wall`?"),
    ("brl.expect('maze', add='difficult')", "metric `difficult`; did you mean `difficulty`?"),
    ("brl.load('two-pads').compile().robot_actions(99)", "99 is not a joint action, 0 to 24"),
    ("brl.load('two-pads').compile().robot_actions('x')", "'x' is not a joint action, 0 to 24"),
    ("brl.load('maze').to_svg(values='optimal')", "must be an array of the shape (5, 8)"),
    ("brl.Action.FORWARD", "there are STAY, NORTH, EAST, SOUTH, WEST, NORTH_EAST,"),
    ("brl.diff('maze', 'default', limit='all')", "limit must be a whole number or None, not"),
    ("brl.grade('.', 'maze', points='marks')", "one of 'regret', 'share', 'success', 'tries'"),
    ("brl.TextEnv('maze')", "did you mean `TextWorld`?"),
    ("brl.Suite.split('a', 'b')", "split() is called on a Suite, not on 'a'"),
    ("brl.load_suite('small-mazes').split('a', 'b')", "split() takes only `name`"),
    ("brl.load('maze').draw(5)", "draw() takes no arguments"),
    ("brl.summary('maze')", "runs must be a Scores or several in a list, not 'maze'"),
    ("brl.Level.from_fields('maze')", "fields must be a mapping, not 'maze'"),
    ("brl.install(3)", "pack must be a path or an Archive, not 3"),
    ("brl.load_suite(3)", "suite must be a name, a path, a mapping or a Suite, not 3"),
    ("brl.loads(3)", "text must be a text, not 3"),
    ("brl.score(3, 'best')", "a level is a name, a path, a mapping or a Level, not int"),
    ("brl.evaluate_many(['maze'], None)", "policy must be"),
    ("brl.compile('maze')", "did you mean `level.compile`, of `level = brl.load(…)`?"),
    ("brl.load_pack('x')", "did you mean `brl.load('PACK/NAME')`?"),
    ("brl.load('maze').tables", "did you mean `compile()`?"),
    ("brl.to_gym('maze')", "did you mean `make`?"),
    ("brl.mutate('maze')", "mutate(): missing a required"),
    ("brl.new_level('x', template='mze')", "did you mean `maze`?"),
    ("brl.solve('maze', criterion='avg')", "did you mean `average`?"),
    ("brl.schema('levl')", "did you mean `level`?"),
    (
        "brl.return_distribution('maze', 'best').quantiles(2)",
        "each share must be from 0 to 1, not 2",
    ),
    ("brl.new_level('x', puddles=-1)", "puddles must be a whole number, at least 0, not -1"),
    ("brl.share('maze', 'ftp://x.org')", "expected an address of the web, without blanks"),
)


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize(("call", "told"), MISTAKES, ids=lambda text: text[:40])
def test_each_call_says_what_is_meant(call: str, told: str) -> None:
    with pytest.raises(Exception) as caught:  # noqa: PT011
        eval(call, SCOPE)
    assert told in str(caught.value)


def test_actions_are_words_and_numbers_in_formatted_text() -> None:
    assert f"{brl.Action(3):>6}|{brl.Action(3)}|{brl.Action(3):2d}" == " south|south| 3"


def public() -> Iterator[tuple[Any, set[str]]]:
    """Yield the package and its classes, and the names of their attributes."""
    yield brl, {*brl.__all__}
    for owner in (getattr(brl, name) for name in brl.__all__):
        if isinstance(owner, type):
            fields = getattr(owner, "model_fields", getattr(owner, "__match_args__", ()))
            yield owner, {*dir(owner), *fields}


def test_names_of_others_lead_to_what_there_is_and_hide_nothing() -> None:
    owners, tables = [*public()], words.words_beside(words.__file__)
    parameters = [
        inspect.signature(each).parameters
        for each in map(vars(brl).get, brl.__all__)
        if inspect.isfunction(each)
    ]
    for ours in tables["attributes"]:
        assert any(ours.partition(" -> ")[0] in known for _, known in owners), ours
    for ours in tables["keywords"]:
        assert any(ours.partition(" -> ")[0] in known for known in parameters), ours
    for ours, others in tables["attributes"].items():
        own, _, written = ours.partition(" -> ")
        if written.startswith("brl."):
            assert {*others.split()} & {*brl.__all__} or own
