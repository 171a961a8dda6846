"""Estimates of regret beside exact regret, and curricula that are made by them; see README.md.

    python benchmarks/design-estimators/run.py --out results

Each part writes a small JSON file, anew after each stage of training. It needs the extra `jax`.
"""

from __future__ import annotations

import argparse
import contextlib
import json
import statistics
import sys
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from itertools import chain
from pathlib import Path
from typing import Any

sys.path.append(str(Path(__file__).parents[2] / "examples"))

import curricula
import estimates
import jax
import jax.numpy as jnp
import numpy as np
from accel_jax import BATCH, COPIES, LENGTH, made
from families import FAMILIES, VIEW, levels_of
from numpy.typing import NDArray
from ppo_jax import NUM_ENVS, NUM_STEPS, Learner, scale_of, varying
from scipy.stats import spearmanr

import babyrobot_levels.jax as brl_jax

Floats = NDArray[np.floating[Any]]

# On a CPU of two cores, computations that are not waited for can wait for each other for ever.
with contextlib.suppress(AttributeError):  # not every version of JAX has the option
    jax.config.update("jax_cpu_enable_async_dispatch", False)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, required=True, help="the folder for the results")
    parser.add_argument("--only", nargs="+", choices=PARTS, default=[*PARTS], help="the parts")
    parser.add_argument("--families", nargs="+", choices=FAMILIES, default=[*FAMILIES])
    parser.add_argument("--seeds", type=int, default=10, help="number of seeds")
    parser.add_argument("--levels", type=int, default=500, help="levels of each family")
    parser.add_argument("--stages", type=int, default=12, help="how often agents are evaluated")
    parser.add_argument("--updates", type=int, default=40, help="updates in each stage")
    parser.add_argument("--episodes", type=int, nargs="+", default=estimates.EPISODES,
                        help="episodes of each level, ascending, for the estimates")  # fmt: skip
    parser.add_argument("--curricula", type=int, default=len(curricula.CURRICULA),
                        help="how many curricula, the first ones")  # fmt: skip
    parser.add_argument("--seconds", type=float, default=float("inf"),
                        help="after how many seconds no stage begins")  # fmt: skip
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    options.began = time.perf_counter()
    for part in options.only:
        PARTS[part](options)


def told(options: argparse.Namespace, text: str) -> None:
    print(f"{time.perf_counter() - options.began:7.1f} s  {text}", flush=True)


def write(options: argparse.Namespace, name: str, key: str, result: dict[str, Any]) -> None:
    """Write a result into a file, beside others that it has."""
    path = options.out / f"{name}.json"
    others = json.loads(path.read_text(encoding="utf-8")) if path.exists() else {}
    facts = {"device": str(jax.devices()[0].device_kind), "jax": jax.__version__}
    text = json.dumps(others | {key: facts | result})
    path.write_text(f"{text}\n", encoding="utf-8")


def rounded(numbers: Any) -> Any:
    return np.round(np.asarray(numbers, float), 4).tolist()


# -- estimates ---------------------------------------------------------------------------------


class Buffers:
    """The levels of some families, in arrays of the same shapes, and who learns in them."""

    def __init__(self, options: argparse.Namespace) -> None:
        levels = {family: levels_of(family, options.levels) for family in options.families}
        told(options, "made the levels")
        first, *_ = levels.values()
        env, _ = brl_jax.make(first, room_for=[*chain(*levels.values())], **VIEW)
        self.params = {family: env.load(each) for family, each in levels.items()}
        self.learner = Learner(env, env.default_params, options.stages * options.updates)
        views = jnp.stack([varying(env, params) for params in self.params.values()])
        self.learner.told = jnp.flatnonzero(views.any(axis=0))
        self.scales = {family: scale_of(params) for family, params in self.params.items()}
        told(options, f"made their tables; {len(self.learner.told)} inputs")


def run_estimates(options: argparse.Namespace) -> None:
    """Learn in each family; compare estimates with exact regret after each stage."""
    buffers, episodes = Buffers(options), tuple(options.episodes)
    write_times(options, buffers)
    learner = buffers.learner
    for family, params in buffers.params.items():
        begin = time.perf_counter()
        start_key, key = jax.random.split(jax.random.key(0))
        keys = jax.random.split(start_key, options.seeds)
        states = estimates.start(keys, params, learner=learner)
        highest = jnp.full((options.seeds, len(episodes), options.levels), -jnp.inf)
        stages: list[dict[str, Any]] = []
        for number in range(options.stages + 1):
            if time.perf_counter() - options.began > options.seconds:
                break
            stage_key = jax.random.fold_in(key, number)
            if number:
                keys = jax.random.split(stage_key, (options.seeds, options.updates))
                states = estimates.learn(states, keys, params, learner=learner)
            highest, scores, truth = estimates.judged(
                states.weights, highest, jax.random.split(stage_key, options.seeds), params,
                buffers.scales[family], learner=learner, episodes=episodes,
            )  # fmt: skip
            stages.append({
                "steps": number * options.updates * NUM_ENVS * NUM_STEPS,
                **{name: rounded(each.mean(axis=1)) for name, each in truth._asdict().items()},
                **compared(scores, truth),
            })  # fmt: skip
            write(options, "estimates", family, {
                "levels": options.levels, "seeds": options.seeds,
                "episodes": episodes, "seconds": time.perf_counter() - begin, "stages": stages,
            })  # fmt: skip
            share, of = np.mean(stages[-1]["share"]), stages[-1]["correlation"]
            middle = len(episodes) // 2
            line = "  ".join(f"{name} {np.nanmean(each[middle]):.2f}" for name, each in of.items())
            told(options, f"{family} {stages[-1]['steps']:11,} steps: share {share:.3f}  {line}")


def compared(scores: dict[str, Any], truth: estimates.Truth) -> dict[str, Any]:
    """Return how well scores order levels by regret, `[numbers of episodes][seeds]` each."""
    regret, success = np.asarray(truth.regret), np.asarray(truth.success)
    # As many episodes as one likes would not make it better.
    exact = np.broadcast_to((success * (1 - success))[:, None], scores["pvl"].shape)
    everything = {name: np.asarray(each) for name, each in scores.items()}
    everything["exact-learnability"] = exact

    def by(measure: Callable[[Floats, Floats], float]) -> dict[str, Any]:
        return {
            name: rounded([[measure(each, true) for each, true in zip(one, regret, strict=True)]
                           for one in found.swapaxes(0, 1)])
            for name, found in everything.items()
        }  # fmt: skip

    return {"correlation": by(rank_correlation), "overlap": by(overlap)}


def rank_correlation(scores: Floats, regret: Floats) -> float:
    """Return Spearman's correlation; 0 if all scores are the same."""
    return float(spearmanr(scores, regret).statistic) if np.ptp(scores) and np.ptp(regret) else 0.0


def overlap(scores: Floats, regret: Floats) -> float:
    """Return which share of the tenth with the most regret is in the tenth with the top scores.

    Among equal scores, chance decides.
    """
    count = max(1, len(regret) // 10)
    order = np.random.default_rng(0).permutation(len(regret))
    tops = [
        set(order[np.argsort(-each[order], kind="stable")[:count]]) for each in (scores, regret)
    ]
    return len(tops[0] & tops[1]) / count


# -- times -------------------------------------------------------------------------------------


def write_times(options: argparse.Namespace, buffers: Buffers) -> None:
    """Time what each score of a level costs, for the policy of one new learner."""
    learner, env = buffers.learner, buffers.learner.env
    middle = options.episodes[len(options.episodes) // 2]

    def estimated(params: Any, best: Any, answers: Any, key: Any, count: int) -> Any:
        played = estimates.play(env, params, *answers, key, count)
        return estimates.estimates(played, params, best, jnp.zeros(params.num_levels))

    def exact(params: Any, best: Any, answers: Any, key: Any) -> Any:
        return brl_jax.regret(params, jnp.exp(answers[0]), best=best, within="max_steps")

    def solved(params: Any, best: Any, answers: Any, key: Any) -> Any:
        return brl_jax.optimum(params, within="max_steps").returns

    def asked(params: Any, best: Any, answers: Any, key: Any) -> Any:
        return estimates.tables(learner, state.weights, params)

    def rolled_out(params: Any, best: Any, answers: Any, key: Any) -> Any:
        return estimates.rollouts(learner, state.weights, params, key, middle)

    functions: dict[str, Any] = {
        "network": asked, "regret": exact, "optimum": solved, f"rollouts-{middle}": rolled_out,
        **{f"estimates-{count}": partial(estimated, count=count) for count in options.episodes},
    }  # fmt: skip
    compiled = {name: jax.jit(function) for name, function in functions.items()}
    for family, params in buffers.params.items():
        state, best = learner.start(jax.random.key(0), params), buffers.scales[family].best
        inputs = params, best, estimates.tables(learner, state.weights, params)
        microseconds = {
            name: timed(partial(function, *inputs)) / options.levels * 1e6
            for name, function in compiled.items()
        }
        write(options, "times", family, {"levels": options.levels, "microseconds": microseconds})
        told(options, f"{family}: {microseconds}")


def timed(function: Callable[[Any], Any], rounds: int = 7) -> float:
    """Return the median of the seconds that a function takes, once it is compiled."""
    keys, seconds = jax.random.split(jax.random.key(0), rounds + 1), []
    jax.block_until_ready(function(keys[0]))
    for key in keys[1:]:
        begin = time.perf_counter()
        jax.block_until_ready(function(key))
        seconds.append(time.perf_counter() - begin)
    return statistics.median(seconds)


# -- curricula ---------------------------------------------------------------------------------


def run_curricula(options: argparse.Namespace) -> None:
    """Learn by each curriculum; evaluate in levels that none of them draws from."""
    # Half the stages, as an update takes longer than of levels that are there.
    stages, every = max(1, options.stages // 2), options.updates
    keys = jax.random.split(jax.random.key(0), (stages + 1, options.seeds, every))

    def compiled(case: tuple[str, str]) -> Any:
        curriculum, tests = made(*case, stages * every)
        begin = curricula.start.lower(keys[0, :, 0], curriculum=curriculum).compile()
        scales = [scale_of(params) for params in tests]
        shapes = jax.eval_shape(partial(curricula.start, curriculum=curriculum), keys[0, :, 0])
        go_on = curricula.stage.lower(shapes, keys[0], scales, curriculum=curriculum).compile()
        told(options, f"compiled {' '.join(case)}")
        return begin, go_on, scales

    cases = curricula.CURRICULA[: options.curricula]
    with ThreadPoolExecutor() as pool:
        jobs = [pool.submit(compiled, case) for case in cases]
        for (method, score), job in zip(cases, jobs, strict=True):
            begin, go_on, scales = job.result()
            began, results = time.perf_counter(), []
            carry = begin(keys[0, :, 0])
            for number in range(1, stages + 1):
                if time.perf_counter() - options.began > options.seconds:
                    break
                carry, figures, walls = go_on(carry, keys[number], scales)
                tests = zip(("mazes", "new"), figures, strict=True)
                results.append({
                    "steps": number * every * BATCH * COPIES * LENGTH,
                    **{test: {name: rounded(each) for name, each in of._asdict().items()}
                       for test, of in tests},
                    "walls": rounded(walls),
                })  # fmt: skip
                write(options, "curricula", f"{method} {score}", {
                    "seeds": options.seeds,
                    "seconds": time.perf_counter() - began, "stages": results,
                })  # fmt: skip
                shares = [np.mean(results[-1][test]["share"]) for test in ("mazes", "new")]
                told(options, f"{method} {score} {results[-1]['steps']:11,} steps: share "
                     f"{shares[0]:.3f} in mazes, {shares[1]:.3f} in new levels")  # fmt: skip


PARTS = {"estimates": run_estimates, "curricula": run_curricula}


if __name__ == "__main__":
    main()
