"""What people type first who know Gymnasium, NumPy, FrozenLake, MiniGrid and ruff.

Each guess works, or is told in one line what to type instead. They were written down before anyone
looked at what things are called here, one or two for each task.
"""

from __future__ import annotations

import shlex
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest
from support.sessions import babyrobot

import babyrobot_levels as brl

WORKS = ""

IN_PYTHON = (
    # Environments.
    ('gymnasium.make("babyrobot/first-key-v0")', WORKS),
    ('brl.make("first-key", render_mode="rgb_array").reset(seed=0)', WORKS),
    ('brl.make_vec("first-key", num_envs=4)', "`LevelVectorEnv`"),
    ("brl.BabyRobotEnv(level)", "`make`"),
    ("env.P", WORKS),
    ("env.action_masks()", WORKS),
    ("env.desc", "`level.draw()`"),
    ("env.nS", "`level.compile()`"),
    ("env.agent_pos", "`state`, and `level.compile().cell(state)`"),
    ("env.max_steps", "`level.max_steps`"),
    ("brl.wrappers", "`make`"),
    # Levels.
    ("brl.levels()", WORKS),
    ("brl.list_levels()", "`levels`"),
    ('brl.load("frist-key")', "did you mean 'first-key'"),
    ('brl.load("first-key.yaml")', "did you mean 'first-key'"),
    ('brl.load_level("first-key")', "`load`"),
    ('brl.Level.from_file("mine.yaml")', "`brl.load`"),
    ('brl.Level.from_dict({"size": [3, 3]})', "`from_fields`"),
    ("brl.Level(size=(4, 4), exit=(3, 3))", "a level begins with `version: 1`"),
    ("brl.Level(version=1, width=4, height=4)", "write `size: [width, height]`"),
    ('brl.load(["SFFF", "FHFH", "FFFH", "HFFG"])', "`brl.import_`"),
    ('brl.import_("map.txt")', WORKS),
    ("level.replace(skid=0.2)", WORKS),
    ('level.add_wall([0, 0], "east")', "`replace(…)`"),
    ("level.width, level.height, level.start, level.exit", WORKS),
    ("level.shape", "`size`"),
    ("level.goal", "`exit`"),
    ('level.save("saved.yaml")', WORKS),
    ('brl.save(level, "saved.yaml")', "`level.save`"),
    ("level.to_json()", "`to_dict()`"),
    ("level.to_text()", "`draw()`"),
    ("level.reset()", "`make()`"),
    ("level.lint()", "`brl.lint(level)`"),
    ('brl.validate("mine.yaml")', WORKS),
    ('brl.check("mine.yaml")', "`validate`"),
    ("brl.metrics(level).difficulty", WORKS),
    ("level.difficulty", "`brl.metrics(level)`"),
    ("level.shortest_path()", "`brl.metrics(level)`"),
    # Pictures.
    ('level.to_png("x.png")', WORKS),
    ("level.render()", "`preview()`"),
    ('brl.preview(level, "x.svg")', WORKS),
    ('brl.preview(level, "x.txt")', "`level.draw()`"),
    ("solution.plot()", "`brl.preview(level, values=solution, policy=solution)`"),
    ("brl.animate(level)", '`preview(level, "x.gif")`'),
    ('brl.preview(level, policy="best")', WORKS),
    # The model, and its solution.
    ("level.P", "`compile()`"),
    ("mdp.P", "`probability`"),
    ("mdp.R", "`reward`"),
    ("mdp.n_states", "`num_states`"),
    ("brl.solve(level).policy", WORKS),
    ("brl.solve(env)", "`env.unwrapped.level`"),
    ("brl.solve(level, gamma=0.9)", "`discount`"),
    ("solution.V", "`values`"),
    ("solution.Q", "`action_values`"),
    ("solution.pi", "`policy`"),
    ('solution["policy"]', "`.policy`"),
    ("brl.value_iteration(level).values", WORKS),
    ("brl.policy_iteration(level).policy", WORKS),
    ("brl.value_iteration(level, theta=1e-6)", "`tolerance`"),
    ("brl.q_learning(level, 50).policy", WORKS),
    ("brl.q_learning(level, num_episodes=50)", "`episodes`"),
    ("brl.q_learning(level, 50, learning_rate=0.1)", "`step_size`"),
    ("brl.sarsa(level, alpha=0.1)", "`step_size`"),
    ("brl.train(level)", "`q_learning`"),
    ("brl.optimal_policy(level)", "`solve`"),
    # Agents.
    ("brl.evaluate(level, policy).expected_return", WORKS),
    ("brl.evaluate(policy, level)", "the level comes first"),
    ('brl.evaluate(level, "best")', WORKS),
    ("brl.evaluate(level, policy).mean", "`expected_return`"),
    ("brl.evaluate_policy(level, policy)", "`evaluate`"),
    ("brl.score(level, policy)", WORKS),
    ("brl.score(policy, level)", "the level comes first"),
    ('brl.score(level, "learned.npy")', WORKS),
    ('brl.score(level, "agent.py:act")', WORKS),
    ('brl.score(level, "agent.py")', "`agent.py:act`"),
    ("brl.score(level, policy).mean", "`summary.mean`"),
    ("brl.score(level, lambda seen: 0, n_episodes=10)", "`episodes`"),
    ('brl.rollout(level, "best", num_steps=20, engine="numpy")', WORKS),
    ("brl.rollout(level, lambda seen: 0, num_steps=20, engine='numpy')", WORKS),
    ("brl.rollout(level, lambda seen: 0, episodes=3)", "`brl.simulate(level, policy, episodes)`"),
    ("brl.simulate(level, lambda seen: 0, 3).mean", WORKS),
    # Many levels.
    ("brl.generate(100, seed=0)", "`count=100`"),
    ("brl.generate(count=2, seed=0)", WORKS),
    ("brl.random_level(seed=0)", "`generate`"),
    ('brl.load_suite("small-mazes")', WORKS),
    ('brl.Suite("small-mazes")', "`brl.load_suite('small-mazes')`"),
    # All else.
    ("brl.Action.NORTH", WORKS),
    ("brl.Action.UP", "`NORTH`"),
    ('brl.Action("south") == 3 and f"{brl.Action(3)}" == "south"', WORKS),
    ('brl.export(level, "frozenlake")', "`frozen-lake`"),
    ("brl.share(level)", WORKS),
    ('brl.diff(level, "maze")', WORKS),
)

ON_THE_COMMAND_LINE = (
    ("babyrobot", "Usage: babyrobot"),
    ("babyrobot help solve", "'solve --help'"),
    ("babyrobot --version", WORKS),
    ("babyrobot version", "'--version'"),
    # Levels.
    ("babyrobot list", WORKS),
    ("babyrobot ls", "'list'"),
    ("babyrobot list --sort size", WORKS),
    ("babyrobot list --max-difficulty 3", "`--difficulty A..B`"),
    ("babyrobot list --difficulty 3", "expected one such as 3..5"),
    ("babyrobot list --json", "`--format`"),
    ("babyrobot list keys", "`--tag keys`"),
    ("babyrobot search key", "'list'"),
    ("babyrobot show first-key", WORKS),
    ("babyrobot info first-key", "'show'"),
    ("babyrobot difficulty first-key", "'show'"),
    ("babyrobot new my.yaml", "'new-level'"),
    ("babyrobot init", "'new-level'"),
    ("babyrobot new-level mine", WORKS),
    ("babyrobot copy first-key my.yaml", "'share LEVEL -o FILE'"),
    ("babyrobot solve small", "did you mean 'small.yaml'"),
    ("babyrobot maze", "'generate'"),
    ("babyrobot generate --seed 0", "add --count N"),
    ("babyrobot generate --size 8 8", "--size 8x5"),
    ("babyrobot generate -n 10", "`--count`"),
    ("babyrobot generate --count 2", WORKS),
    ("babyrobot harder first-key", "'generate --from LEVEL --difficulty A..B'"),
    ("babyrobot open small.yaml", "'edit' (edit a level in the browser)"),
    # Checks.
    ("babyrobot validate small.yaml", WORKS),
    ("babyrobot validate small", "did you mean `small.yaml`"),
    ("babyrobot validate .", WORKS),
    ("babyrobot check .", "'validate'"),
    ("babyrobot lint --fix small.yaml", WORKS),
    ("babyrobot lint --list-rules", "`babyrobot rule`"),
    ("babyrobot lint --explain BR501", "`babyrobot rule`"),
    ("babyrobot lint --output-format json small.yaml", "`--format`"),
    ("babyrobot rule BR501", WORKS),
    ("babyrobot explain BR501", "'rule'"),
    ("babyrobot format --check small.yaml", WORKS),
    ("babyrobot format --write small.yaml", "`babyrobot format`"),
    ("babyrobot generate --metric difficulty=3..5", "`--difficulty A..B`"),
    ("babyrobot fmt small.yaml", "'format'"),
    ("babyrobot fix small.yaml", "'lint --fix'"),
    ("babyrobot expect --check small.yaml", "`babyrobot lint`"),
    # Pictures.
    ("babyrobot preview first-key", WORKS),
    ("babyrobot preview first-key -o new.svg", WORKS),
    ("babyrobot preview first-key -o pictures/", WORKS),
    ("babyrobot preview first-key x.png", "`-o x.png`"),
    ("babyrobot preview first-key --save x.png", "`--output`"),
    ("babyrobot preview first-key --values --policy", WORKS),
    ("babyrobot render first-key", "'preview'"),
    ("babyrobot gif first-key", "'preview LEVEL -o FILE.gif'"),
    ("babyrobot gallery first-key -o site", WORKS),
    ("babyrobot serve", "'gallery'"),
    # Play, and solve.
    ("babyrobot run first-key", "'play'"),
    ("babyrobot hint first-key", "`babyrobot play LEVEL` gives hints"),
    ("babyrobot replay small.yaml", "babyrobot play small.yaml"),
    ("babyrobot solve first-key", WORKS),
    ("babyrobot solve first-key --gamma 0.9", "`--discount`"),
    ("babyrobot solve first-key --algorithm value-iteration", "`brl.value_iteration(level)`"),
    ("babyrobot solve first-key --json", "`--format`"),
    ("babyrobot solve first-key -o policy.npy", "give a file such as rows.jsonl"),
    ("babyrobot policy first-key", "'solve'"),
    ("babyrobot train first-key", "`brl.q_learning(level)`"),
    # Agents.
    ("babyrobot score best first-key", WORKS),
    ("babyrobot score first-key best", "babyrobot score best LEVEL"),
    ("babyrobot score best --level first-key", "babyrobot score best first-key"),
    ("babyrobot score agent.py first-key", "`agent.py:act`"),
    ("babyrobot score agent.py", "`agent.py:act`"),
    ("babyrobot score agent.py:policy first-key", "`agent.py:act`"),
    ("babyrobot score agent.py:act first-key", WORKS),
    ("babyrobot score learned.npy first-key", WORKS),
    ("babyrobot score other.json first-key", "a policy is an array of actions"),
    ("babyrobot evaluate agent.py first-key", "'score'"),
    ("babyrobot benchmark agent.py", "'score'"),
    # Other programs, and other people.
    ("babyrobot import map.txt", WORKS),
    ("babyrobot convert map.txt", "'import'"),
    ("babyrobot export first-key --format frozen-lake", "`--to`"),
    ("babyrobot export first-key tiled", "`--to tiled`"),
    ("babyrobot export first-key --to tiled", WORKS),
    ("babyrobot export first-key --to yaml", "babyrobot share LEVEL -o FILE.yaml"),
    ("babyrobot export first-key -o level.yml", "babyrobot share LEVEL -o FILE.yaml"),
    ("babyrobot share first-key", WORKS),
    ("babyrobot share --link small.yaml", "--link needs BASE"),
    ("babyrobot compare first-key first-key", WORKS),
    ("babyrobot diff first-key first-key", WORKS),
    ('babyrobot course new "My Course"', "babyrobot course build 'My Course'"),
    ("babyrobot completion", "'--install-completion'"),
    ("babyrobot new-level levels/My_Level.yaml", "'my-level'"),
    ("babyrobot generate small.yaml --count 3", "`generate --from`"),
    ("babyrobot validate ada.brlplay", "`babyrobot replay`"),
    ("babyrobot score broken.py:act first-key", "the agent failed: SyntaxError"),
    # What stands in a wrong place, or belongs to another command.
    ("babyrobot small.yaml validate", "`babyrobot validate small.yaml`"),
    ("babyrobot small.yaml", "`babyrobot preview small.yaml`"),
    ("babyrobot --format png preview maze", "Options stand behind the command"),
    ("babyrobot preview maze -values", "Did you mean `--values`?"),
    ("babyrobot score best maze --seed 3", "Leave it out: it is an option of `generate`,"),
    ("babyrobot dataset maze --format xyz", "Leave it out: it is an option of "),
    ("babyrobot export maze two-pads --to tiled", "Call it once for each of them"),
    ("babyrobot export maze --to png -o x.svg", "x.svg is no file of the format png"),
    ("babyrobot import small.yaml out.yaml", "give one with -o out.yaml"),
    ("babyrobot preview maze -o x.svg --format pdf", "x.svg is no file of the format pdf"),
    ("babyrobot generate --count 3 --algorithm dfs", "Did you mean `depth-first`?"),
    ("babyrobot generate --count 3 --rewards stp=-1", "write `step=-1`"),
    ("babyrobot generate maze --count 3", "it is a level: `brl.load('maze')`, `--from maze`"),
    ("babyrobot solve classics --split train", "there is no split 'train': the suite has none"),
    ("babyrobot import small.yaml --from minigrid", "small.yaml is already a level file"),
    ("babyrobot import x.png", "it reads texts and zip files"),
    ("babyrobot validate x.png", "a level is written in YAML or JSON, and this is a picture"),
    ("babyrobot import FrozenLake", "named with its version, such as FrozenLake-v1"),
    ("babyrobot import small.yaml --to tiled", "`babyrobot export LEVEL --to FORMAT`"),
    ("babyrobot generate --count 2 --needs key", "`--expect needs=key`"),
    ("babyrobot show https://example.org/level.yaml", "download what is there"),
    ("babyrobot import https://example.org/map.txt", "download what is there"),
    ("babyrobot install https://example.org/zoo.brlpack", "download what is there"),
    ("babyrobot preview maze,two-pads", "give each of several by itself"),
    ("babyrobot score maze,two-pads", "`babyrobot score random maze two-pads`"),
    ("babyrobot edit agent.py", "no level file; give one that ends in .yaml"),
    ("babyrobot share maze --link ftp://example.org", "expected an address of the web, without"),
    ("babyrobot grade hand-ins --course nosuch", "there is no course, folder or level 'nosuch'"),
)


@pytest.fixture
def folder(here: Path) -> Path:
    """Stand in a folder with a level, a map, and agents."""
    (here / "small.yaml").write_text("version: 1\nsize: [4, 3]\n", "utf-8")
    (here / "map.txt").write_text("SFFF\nFHFH\nFFFH\nHFFG\n", "utf-8")
    (here / "agent.py").write_text("def act(observation):\n    return 0\n", "utf-8")
    (here / "broken.py").write_text("def act(observation) return 0\n", "utf-8")
    (here / "ada.brlplay").write_text('{"play": 1}\n', "utf-8")
    (here / "other.json").write_text('{"a": "b"}', "utf-8")
    (here / "x.png").write_bytes(b"\x89PNG")
    np.save(here / "learned.npy", brl.solve("first-key").policy)
    return here


@pytest.fixture(scope="module")
def scope() -> dict[str, Any]:
    """Return the names that guesses have at hand."""
    level = brl.load("first-key")
    solution, env = brl.solve(level), brl.make(level)
    env.reset(seed=0)
    more = {"env": env.unwrapped, "mdp": level.compile(), "policy": solution.policy}
    return {"brl": brl, "gymnasium": gymnasium, "level": level, "solution": solution, **more}


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize(("guess", "led"), IN_PYTHON, ids=lambda text: text[:60])
def test_guesses_in_python(guess: str, led: str, scope: dict[str, Any], folder: Path) -> None:
    if led == WORKS:
        assert eval(guess, scope) is not False
        return
    with pytest.raises(Exception) as caught:  # noqa: PT011
        eval(guess, scope)
    assert any(led in line for line in str(caught.value).splitlines())


@pytest.mark.parametrize(("guess", "led"), ON_THE_COMMAND_LINE, ids=lambda text: text[:60])
def test_guesses_on_the_command_line(guess: str, led: str, folder: Path) -> None:
    result = babyrobot(*shlex.split(guess)[1:])
    assert any(led in line for line in (result.out + result.err).splitlines() or [""])
    assert result.status == 0 or led != WORKS, result
