"""babyrobot-levels: grid worlds as files.

A level is a YAML file: it is read, checked, compiled into exact tables and played as a Gymnasium
environment. Importing this package makes the environments known to Gymnasium (at once if
Gymnasium is loaded, else as soon as it is) and costs next to nothing: every name below is
imported when it is first used.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

from babyrobot_levels.envs import gymnasium_hook

if TYPE_CHECKING:
    from babyrobot_levels.analysis.certificate import Certificate as Certificate
    from babyrobot_levels.analysis.certificate import ComparisonError as ComparisonError
    from babyrobot_levels.analysis.compare import compare as compare
    from babyrobot_levels.analysis.diff import Difference as Difference
    from babyrobot_levels.analysis.diff import diff as diff
    from babyrobot_levels.analysis.learning.episodes import monte_carlo as monte_carlo
    from babyrobot_levels.analysis.learning.episodes import q_learning as q_learning
    from babyrobot_levels.analysis.learning.episodes import sarsa as sarsa
    from babyrobot_levels.analysis.learning.results import Sweep as Sweep
    from babyrobot_levels.analysis.learning.results import Trials as Trials
    from babyrobot_levels.analysis.learning.sweeps import policy_evaluation as policy_evaluation
    from babyrobot_levels.analysis.learning.sweeps import policy_iteration as policy_iteration
    from babyrobot_levels.analysis.learning.sweeps import value_iteration as value_iteration
    from babyrobot_levels.analysis.metrics import Metrics as Metrics
    from babyrobot_levels.analysis.metrics import metrics as metrics
    from babyrobot_levels.analysis.solver.distribution import (
        ReturnDistribution as ReturnDistribution,
    )
    from babyrobot_levels.analysis.solver.distribution import (
        return_distribution as return_distribution,
    )
    from babyrobot_levels.analysis.solver.evaluation import evaluate as evaluate
    from babyrobot_levels.analysis.solver.evaluation import simulate as simulate
    from babyrobot_levels.analysis.solver.evaluation import success_within as success_within
    from babyrobot_levels.analysis.solver.optimum import solve as solve
    from babyrobot_levels.analysis.solver.results import EpisodeTooLongError as EpisodeTooLongError
    from babyrobot_levels.analysis.solver.results import Evaluation as Evaluation
    from babyrobot_levels.analysis.solver.results import Simulation as Simulation
    from babyrobot_levels.analysis.solver.results import Solution as Solution
    from babyrobot_levels.analysis.solver.results import (
        UndefinedReturnError as UndefinedReturnError,
    )
    from babyrobot_levels.analysis.strip import strip as strip
    from babyrobot_levels.convert.babyrobot.reading import from_setup as from_setup
    from babyrobot_levels.convert.conversion import ConversionWarning as ConversionWarning
    from babyrobot_levels.convert.registration import register_babyrobot as register_babyrobot
    from babyrobot_levels.editor.hosts.notebook import edit as edit
    from babyrobot_levels.envs.engine.rollout import Rollout as Rollout
    from babyrobot_levels.envs.engine.rollout import rollout as rollout
    from babyrobot_levels.envs.samplers import PrioritizedSampler as PrioritizedSampler
    from babyrobot_levels.envs.samplers import Sampler as Sampler
    from babyrobot_levels.envs.samplers import UniformSampler as UniformSampler
    from babyrobot_levels.envs.samplers import WeightedSampler as WeightedSampler
    from babyrobot_levels.envs.single import LevelEnv as LevelEnv
    from babyrobot_levels.envs.vector.env import LevelVectorEnv as LevelVectorEnv
    from babyrobot_levels.generate.batch import FolderError as FolderError
    from babyrobot_levels.generate.batch import Generated as Generated
    from babyrobot_levels.generate.levels import generate_levels as generate_levels
    from babyrobot_levels.generate.search import UnsatisfiableError as UnsatisfiableError
    from babyrobot_levels.generate.suites import Suite as Suite
    from babyrobot_levels.generate.suites import load_suite as load_suite
    from babyrobot_levels.language.formatting.formatter import format_text as format_text
    from babyrobot_levels.language.play import PlayError as PlayError
    from babyrobot_levels.library.catalogue import LevelInfo as LevelInfo
    from babyrobot_levels.library.catalogue import levels as levels
    from babyrobot_levels.library.catalogue import load as load
    from babyrobot_levels.library.level import Level as Level
    from babyrobot_levels.library.reading import loads as loads
    from babyrobot_levels.lint.runner import check as check
    from babyrobot_levels.mdp.actions import Action as Action
    from babyrobot_levels.mdp.actions import Turn as Turn
    from babyrobot_levels.mdp.configurations import Configuration as Configuration
    from babyrobot_levels.mdp.configurations import Things as Things
    from babyrobot_levels.mdp.grid import Grid as Grid
    from babyrobot_levels.mdp.tables import Mdp as Mdp
    from babyrobot_levels.parallel.executor import ExecutorError as ExecutorError
    from babyrobot_levels.parallel.executor import WorkerDiedError as WorkerDiedError
    from babyrobot_levels.publish.gallery import Gallery as Gallery
    from babyrobot_levels.publish.gallery import write_gallery as write_gallery
    from babyrobot_levels.publish.sheet import Sheet as Sheet
    from babyrobot_levels.publish.sheet import sheet as sheet
    from babyrobot_levels.scoring.datasets import to_minari as to_minari
    from babyrobot_levels.scoring.many import LevelMetrics as LevelMetrics
    from babyrobot_levels.scoring.many import LevelValue as LevelValue
    from babyrobot_levels.scoring.many import evaluate_many as evaluate_many
    from babyrobot_levels.scoring.many import metrics_many as metrics_many
    from babyrobot_levels.scoring.many import solve_many as solve_many
    from babyrobot_levels.scoring.plays.files import Play as Play
    from babyrobot_levels.scoring.plays.files import read_plays as read_plays
    from babyrobot_levels.scoring.plays.grades import Grade as Grade
    from babyrobot_levels.scoring.plays.grades import Grades as Grades
    from babyrobot_levels.scoring.plays.grades import grade as grade
    from babyrobot_levels.scoring.plays.record import RecordPlay as RecordPlay
    from babyrobot_levels.scoring.plays.verify import Verification as Verification
    from babyrobot_levels.scoring.plays.verify import verify_play as verify_play
    from babyrobot_levels.scoring.results import LevelScore as LevelScore
    from babyrobot_levels.scoring.results import Scores as Scores
    from babyrobot_levels.scoring.score import score as score
    from babyrobot_levels.text.diagnostics import Diagnostic as Diagnostic
    from babyrobot_levels.text.diagnostics import Severity as Severity
    from babyrobot_levels.text.errors import BabyRobotError as BabyRobotError
    from babyrobot_levels.text.errors import LevelError as LevelError
    from babyrobot_levels.text.errors import LevelNotFoundError as LevelNotFoundError
    from babyrobot_levels.text.errors import SuiteNotFoundError as SuiteNotFoundError

__version__ = "0.1.0"

_HOMES = {
    "Action": "mdp.actions",
    "BabyRobotError": "text.errors",
    "Certificate": "analysis.certificate",
    "ComparisonError": "analysis.certificate",
    "Configuration": "mdp.configurations",
    "ConversionWarning": "convert.conversion",
    "Diagnostic": "text.diagnostics",
    "Difference": "analysis.diff",
    "EpisodeTooLongError": "analysis.solver.results",
    "Evaluation": "analysis.solver.results",
    "ExecutorError": "parallel.executor",
    "FolderError": "generate.batch",
    "Gallery": "publish.gallery",
    "Generated": "generate.batch",
    "Grade": "scoring.plays.grades",
    "Grades": "scoring.plays.grades",
    "Grid": "mdp.grid",
    "Level": "library.level",
    "LevelEnv": "envs.single",
    "LevelError": "text.errors",
    "LevelInfo": "library.catalogue",
    "LevelMetrics": "scoring.many",
    "LevelNotFoundError": "text.errors",
    "LevelScore": "scoring.results",
    "LevelValue": "scoring.many",
    "LevelVectorEnv": "envs.vector.env",
    "Mdp": "mdp.tables",
    "Metrics": "analysis.metrics",
    "Play": "scoring.plays.files",
    "PlayError": "language.play",
    "PrioritizedSampler": "envs.samplers",
    "RecordPlay": "scoring.plays.record",
    "ReturnDistribution": "analysis.solver.distribution",
    "Rollout": "envs.engine.rollout",
    "Sampler": "envs.samplers",
    "Scores": "scoring.results",
    "Severity": "text.diagnostics",
    "Sheet": "publish.sheet",
    "Simulation": "analysis.solver.results",
    "Solution": "analysis.solver.results",
    "UnsatisfiableError": "generate.search",
    "Suite": "generate.suites",
    "SuiteNotFoundError": "text.errors",
    "Sweep": "analysis.learning.results",
    "Things": "mdp.configurations",
    "Trials": "analysis.learning.results",
    "Turn": "mdp.actions",
    "UndefinedReturnError": "analysis.solver.results",
    "UniformSampler": "envs.samplers",
    "Verification": "scoring.plays.verify",
    "WeightedSampler": "envs.samplers",
    "WorkerDiedError": "parallel.executor",
    "check": "lint.runner",
    "compare": "analysis.compare",
    "diff": "analysis.diff",
    "edit": "editor.hosts.notebook",
    "evaluate": "analysis.solver.evaluation",
    "evaluate_many": "scoring.many",
    "format_text": "language.formatting.formatter",
    "from_setup": "convert.babyrobot.reading",
    "generate_levels": "generate.levels",
    "grade": "scoring.plays.grades",
    "levels": "library.catalogue",
    "load": "library.catalogue",
    "load_suite": "generate.suites",
    "loads": "library.reading",
    "metrics": "analysis.metrics",
    "metrics_many": "scoring.many",
    "monte_carlo": "analysis.learning.episodes",
    "policy_evaluation": "analysis.learning.sweeps",
    "policy_iteration": "analysis.learning.sweeps",
    "q_learning": "analysis.learning.episodes",
    "read_plays": "scoring.plays.files",
    "register_babyrobot": "convert.registration",
    "return_distribution": "analysis.solver.distribution",
    "rollout": "envs.engine.rollout",
    "sarsa": "analysis.learning.episodes",
    "score": "scoring.score",
    "sheet": "publish.sheet",
    "simulate": "analysis.solver.evaluation",
    "solve": "analysis.solver.optimum",
    "solve_many": "scoring.many",
    "strip": "analysis.strip",
    "success_within": "analysis.solver.evaluation",
    "verify_play": "scoring.plays.verify",
    "to_minari": "scoring.datasets",
    "value_iteration": "analysis.learning.sweeps",
    "write_gallery": "publish.gallery",
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


gymnasium_hook.install()
