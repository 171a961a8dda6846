"""babyrobot-levels: grid worlds as files.

A level is a YAML file: it is read, checked, compiled into exact tables and played as a Gymnasium
environment. Importing this package makes the environments known to Gymnasium (at once if
Gymnasium is loaded, else as soon as it is) and costs next to nothing: every name below is
imported when it is first used.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

from babyrobot_levels import _gymnasium_hook

if TYPE_CHECKING:
    from babyrobot_levels.actions import Action as Action
    from babyrobot_levels.catalogue import LevelInfo as LevelInfo
    from babyrobot_levels.catalogue import levels as levels
    from babyrobot_levels.catalogue import load as load
    from babyrobot_levels.certificate import Certificate as Certificate
    from babyrobot_levels.certificate import compare as compare
    from babyrobot_levels.convert.babyrobot.reading import from_setup as from_setup
    from babyrobot_levels.convert.conversion import ConversionWarning as ConversionWarning
    from babyrobot_levels.convert.registration import register_babyrobot as register_babyrobot
    from babyrobot_levels.diagnostics import Diagnostic as Diagnostic
    from babyrobot_levels.diagnostics import Severity as Severity
    from babyrobot_levels.difference.levels import Difference as Difference
    from babyrobot_levels.difference.levels import diff as diff
    from babyrobot_levels.engine.rollout import Rollout as Rollout
    from babyrobot_levels.engine.rollout import rollout as rollout
    from babyrobot_levels.envs.vector.env import LevelVectorEnv as LevelVectorEnv
    from babyrobot_levels.errors import BabyRobotError as BabyRobotError
    from babyrobot_levels.errors import LevelError as LevelError
    from babyrobot_levels.errors import LevelNotFoundError as LevelNotFoundError
    from babyrobot_levels.errors import SuiteNotFoundError as SuiteNotFoundError
    from babyrobot_levels.formatting.formatter import format_text as format_text
    from babyrobot_levels.games import ComparisonError as ComparisonError
    from babyrobot_levels.generate.search import StarvedError as StarvedError
    from babyrobot_levels.grid import Grid as Grid
    from babyrobot_levels.learning.monte_carlo import monte_carlo as monte_carlo
    from babyrobot_levels.learning.results import Sweep as Sweep
    from babyrobot_levels.learning.results import Trials as Trials
    from babyrobot_levels.learning.sweeps import policy_evaluation as policy_evaluation
    from babyrobot_levels.learning.sweeps import policy_iteration as policy_iteration
    from babyrobot_levels.learning.sweeps import value_iteration as value_iteration
    from babyrobot_levels.learning.temporal_difference import q_learning as q_learning
    from babyrobot_levels.learning.temporal_difference import sarsa as sarsa
    from babyrobot_levels.level import Level as Level
    from babyrobot_levels.lint.check import check as check
    from babyrobot_levels.mdp import Mdp as Mdp
    from babyrobot_levels.measures.metrics import Metrics as Metrics
    from babyrobot_levels.measures.metrics import metrics as metrics
    from babyrobot_levels.reading import loads as loads
    from babyrobot_levels.solver.errors import NoTotalError as NoTotalError
    from babyrobot_levels.solver.errors import TooLongError as TooLongError
    from babyrobot_levels.solver.evaluation import evaluate as evaluate
    from babyrobot_levels.solver.optimum import solve as solve
    from babyrobot_levels.solver.results import Evaluation as Evaluation
    from babyrobot_levels.solver.results import Simulation as Simulation
    from babyrobot_levels.solver.results import Solution as Solution
    from babyrobot_levels.solver.simulation import simulate as simulate
    from babyrobot_levels.solver.simulation import success_within as success_within
    from babyrobot_levels.suites import Suite as Suite
    from babyrobot_levels.suites import load_suite as load_suite

__version__ = "0.1.0"

_HOMES = {
    "Action": "actions",
    "BabyRobotError": "errors",
    "Certificate": "certificate",
    "ComparisonError": "games",
    "ConversionWarning": "convert.conversion",
    "Diagnostic": "diagnostics",
    "Difference": "difference.levels",
    "Evaluation": "solver.results",
    "Grid": "grid",
    "Level": "level",
    "LevelError": "errors",
    "LevelInfo": "catalogue",
    "LevelNotFoundError": "errors",
    "LevelVectorEnv": "envs.vector.env",
    "Mdp": "mdp",
    "Metrics": "measures.metrics",
    "NoTotalError": "solver.errors",
    "Rollout": "engine.rollout",
    "Severity": "diagnostics",
    "Simulation": "solver.results",
    "Solution": "solver.results",
    "StarvedError": "generate.search",
    "Suite": "suites",
    "SuiteNotFoundError": "errors",
    "Sweep": "learning.results",
    "TooLongError": "solver.errors",
    "Trials": "learning.results",
    "check": "lint.check",
    "compare": "certificate",
    "diff": "difference.levels",
    "evaluate": "solver.evaluation",
    "format_text": "formatting.formatter",
    "from_setup": "convert.babyrobot.reading",
    "levels": "catalogue",
    "load": "catalogue",
    "load_suite": "suites",
    "loads": "reading",
    "metrics": "measures.metrics",
    "monte_carlo": "learning.monte_carlo",
    "policy_evaluation": "learning.sweeps",
    "policy_iteration": "learning.sweeps",
    "q_learning": "learning.temporal_difference",
    "register_babyrobot": "convert.registration",
    "rollout": "engine.rollout",
    "sarsa": "learning.temporal_difference",
    "simulate": "solver.simulation",
    "solve": "solver.optimum",
    "success_within": "solver.simulation",
    "value_iteration": "learning.sweeps",
}

__all__ = sorted([*_HOMES, "__version__"])


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value = getattr(importlib.import_module(f"{__name__}.{_HOMES[name]}"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return __all__


_gymnasium_hook.install()
