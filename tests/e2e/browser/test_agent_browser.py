"""An agent on the page of a level: beside the optimum, and what its differences cost."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from playwright.sync_api import expect
from support.combinations import swept
from support.playground import Playground

import babyrobot_levels as brl
from babyrobot_levels.analysis.agent_guides import page_agent
from babyrobot_levels.analysis.guides import guide_of

KEY = brl.load("first-key").replace(max_steps=12, display={"robot": {"speed": 100}})
LAKE = brl.load("frozen-lake").replace(display={"robot": {"speed": 100}})


def open_agent(ground: Playground, level: Any, policy: Any, **options: Any) -> None:
    solution = brl.solve(level) if options.pop("answers", True) else None
    guide = None if solution is None else guide_of(level, solution)
    best = None if guide is None else guide.expected_return
    agent = page_agent(level, policy, solution, best)
    ground.open(level, guide=guide, agent=agent, policy="agent", arrows=True, **options)


def numbers(ground: Playground) -> list[str]:
    return ground.page.locator("#values text").all_text_contents()


def choose(ground: Playground, name: str) -> None:
    ground.page.locator("#views label", has_text=name).click()


def wrong_turn() -> Any:
    """Return an optimal policy of the first key with one action that is not optimal."""
    policy = np.array(brl.solve(KEY).policy)
    policy[0, 0, 1] = brl.Action.EAST
    return policy


def test_one_chooses_what_the_cells_show(ground: Playground) -> None:
    policy = np.array(brl.solve(LAKE).policy)
    policy[3, 2] = brl.Action.NORTH
    open_agent(ground, LAKE, policy, values=True)
    of_agent = numbers(ground)
    choose(ground, "Optimum")
    best = numbers(ground)
    assert "0.94" in best
    assert "0.94" not in of_agent
    choose(ground, "Difference")
    cost = brl.solve(LAKE).values[3, 2] - brl.solve(LAKE).action_values[3, 2, 1]
    assert numbers(ground) == [f"{cost:.2f}"]
    expect(ground.page.locator("#cost-scale")).to_be_visible()
    expect(ground.page.locator("#value-scale")).to_be_hidden()
    choose(ground, "Agent")
    assert numbers(ground) == of_agent
    expect(ground.page.locator("#cost-scale")).to_be_hidden()


def test_the_choice_is_one_of_the_keyboard_and_of_screen_readers(ground: Playground) -> None:
    open_agent(ground, KEY, wrong_turn())
    group = ground.page.get_by_role("group", name="Values and actions", exact=True)
    chosen = group.get_by_role("radio", name="Agent")
    expect(chosen).to_be_checked()
    chosen.focus()
    ground.press("ArrowRight")
    expect(group.get_by_role("radio", name="Difference")).to_be_checked()
    expect(group).to_contain_text("Light arrows: optimal ones.")
    # The arrow key chose, and did not move the robot.
    assert ground.number("steps") == 0


def test_the_table_tells_each_difference_and_shows_its_cell(ground: Playground) -> None:
    open_agent(ground, KEY, wrong_turn())
    table = ground.page.get_by_role("table")
    rows = [row.split("\t") for row in table.locator("tbody tr").all_inner_texts()]
    assert [row[:4] for row in rows] == [["[1, 0] while nothing is held", "east", "west", "2"]]
    table.locator("tbody tr").hover()
    assert ground.page.locator("#outlines").get_attribute("d")
    ground.page.emulate_media(media="print")
    expect(table).to_be_visible()


def test_what_is_watched_is_what_is_shown(ground: Playground) -> None:
    open_agent(ground, KEY, wrong_turn())
    watch = ground.page.locator("#watch")
    expect(watch).to_contain_text("Watch the agent")
    watch.click()
    expect(ground.page.locator("#message")).to_contain_text("Time limit", timeout=30_000)
    choose(ground, "Optimum")
    expect(watch).to_contain_text("Watch the optimal policy")
    watch.click()
    expect(ground.page.locator("#message")).to_have_attribute("data-kind", "exit")
    assert ground.number("return") == brl.solve(KEY).expected_return


@pytest.mark.parametrize("seed", swept([7], [0]))
def test_an_agent_draws_its_actions_as_in_films(ground: Playground, seed: int) -> None:
    policy = np.random.default_rng(3).dirichlet(np.ones(5), 16)
    env, random = LAKE.make(observation="index"), np.random.default_rng(seed)
    state, _ = env.reset(seed=seed)
    actions, is_over = [], False
    while not is_over:
        actions.append(int(random.choice(5, p=policy[state])))
        state, _, terminated, truncated, _ = env.step(actions[-1])
        is_over = terminated or truncated
    open_agent(ground, LAKE, policy, seed=seed)
    ground.press("p")
    expect(ground.page.locator("#result")).to_be_visible(timeout=20_000)
    assert ground.page.evaluate("() => game.taken.map(({ action }) => action)") == actions


def test_without_answers_there_are_the_actions_of_the_agent_alone(ground: Playground) -> None:
    policy = np.full((*KEY.compile().shape, 5), np.nan)
    policy[0, 1, 2] = np.eye(5)[brl.Action.NORTH]
    open_agent(ground, KEY, policy, answers=False)
    for name in ("#views", "#show-values", "#hint"):
        expect(ground.page.locator(name)).to_be_hidden()
    expect(ground.page.locator("#differences")).to_have_count(0)
    expect(ground.page.locator("#policy > g:not(:empty)")).to_have_count(1)
    ground.page.locator("#watch").click()
    expect(ground.page.locator("#message")).to_have_text("The agent has no action here.")
    assert ground.number("steps") == 1


def test_things_show_the_agent_with_what_is_held(ground: Playground) -> None:
    policy = np.array(brl.solve(KEY).policy)
    policy[1, 1, 2] = brl.Action.NORTH
    open_agent(ground, KEY, policy, values=True)
    choose(ground, "Difference")
    assert numbers(ground) == []
    ground.page.locator("#sets label", has_text="key").click()
    assert numbers(ground) == ["2"]


def test_a_link_to_another_level_has_no_agent(ground: Playground, tmp_path: Path) -> None:
    from babyrobot_levels.render.page import link_fragment

    open_agent(ground, KEY, wrong_turn())
    ground.follow(link_fragment(LAKE, LAKE, guide_of(LAKE)))
    for name in ("#views", "#differences"):
        expect(ground.page.locator(name)).to_be_hidden()
    expect(ground.page.locator("#watch")).to_contain_text("Watch the optimal policy")
