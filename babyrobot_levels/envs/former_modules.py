"""Serves modules under the names that they had before, with a DeprecationWarning.

An old name gives the module itself, not a copy, so that classes stay the same for `isinstance`
and for what was pickled under the old names.
"""

from __future__ import annotations

import importlib
import sys
import warnings
from collections.abc import Sequence
from importlib.machinery import ModuleSpec
from types import ModuleType

_PACKAGE = "babyrobot_levels."

MOVED = {
    "_gymnasium_hook": "envs.gymnasium_hook",
    "actions": "mdp.actions",
    "catalogue": "library.catalogue",
    "certificate": "analysis.compare",
    "cli.answers": "cli.pictures",
    "cli.cite": "cli.show",
    "cli.conversions": "cli.convert",
    "cli.differences": "cli.diff",
    "cli.diffs": "cli.console",
    "cli.export_level": "cli.convert",
    "cli.git": "cli.diff",
    "cli.import_level": "cli.convert",
    "cli.list_packs": "cli.list_levels",
    "cli.orders": "cli.suite_options",
    "cli.print_schema": "cli.schema",
    "cli.progress": "cli.parallel",
    "cli.resolve": "cli.share",
    "cli.table": "cli.console",
    "compiler": "mdp.compiler",
    "compiler.arrivals": "mdp.compiler.outcomes",
    "compiler.branches": "mdp.compiler.outcomes",
    "compiler.warps": "mdp.compiler.moves",
    "convert.babyrobot.looks": "convert.babyrobot.reading",
    "convert.checked": "convert.data",
    "convert.file_text": "convert.formats",
    "convert.marks": "convert.blocks",
    "convert.maze_dataset": "convert.block_maps",
    "convert.maze_map": "convert.block_maps",
    "convert.minigrid": "convert.minigrids.text",
    "convert.sokoban": "convert.block_maps",
    "convert.tiled.tilesets": "convert.tiled.tiles",
    "diagnostics": "text.diagnostics",
    "difference": "analysis",
    "difference.changes": "analysis.diff",
    "difference.common": "analysis.diff",
    "difference.levels": "analysis.diff",
    "digest": "mdp.digest",
    "drawing": "language.drawing",
    "engine": "envs.engine",
    "engine.arguments": "envs.engine.factory",
    "engine.choice": "envs.engine.factory",
    "engine.packing": "envs.engine.compiled",
    "engine.robots": "envs.engine.state",
    "engine.slots": "envs.engine.tables",
    "envs.ipython": "envs.rendering",
    "envs.padding": "envs.observations",
    "envs.pictures": "envs.rendering",
    "envs.vector.arguments": "envs.arguments",
    "envs.vector.changing": "envs.vector.levels",
    "envs.vector.families": "envs.vector.levels",
    "envs.vector.pictures": "envs.vector.rendering",
    "envs.vector.slots": "envs.vector.levels",
    "envs.vector.spaces": "envs.spaces",
    "errors": "text.errors",
    "files": "text.files",
    "folders": "text.files",
    "formatting": "language.formatting",
    "formatting.fields": "language.formatting.tree",
    "formatting.kept": "language.formatting.scalars",
    "games": "analysis.compare",
    "generate.folder": "generate.batch",
    "generate.order": "generate.batch",
    "generate.workers": "generate.batch",
    "grid": "mdp.grid",
    "learning": "analysis.learning",
    "learning.monte_carlo": "analysis.learning.episodes",
    "learning.temporal_difference": "analysis.learning.episodes",
    "level": "library.level",
    "lint.across": "lint.runner",
    "lint.best": "lint.optimal_policy",
    "lint.case": "lint.context",
    "lint.check": "lint.runner",
    "lint.drawn": "lint.finding",
    "lint.edits": "lint.fixes",
    "lint.effects": "lint.terrain",
    "lint.ground": "lint.terrain",
    "lint.pages": "lint.registry",
    "lint.reach": "mdp.reachability",
    "lint.silence": "lint.suppressions",
    "lint.wording": "lint.finding",
    "loader": "language.validation",
    "maze": "mdp.mazes",
    "maze.depth_first": "mdp.mazes.algorithms",
    "maze.division": "mdp.mazes.algorithms",
    "maze.draws": "mdp.mazes.lattice",
    "maze.growth": "mdp.mazes.algorithms",
    "maze.kruskal": "mdp.mazes.algorithms",
    "maze.loops": "mdp.mazes.lattice",
    "maze.random_walks": "mdp.mazes.algorithms",
    "maze.rows": "mdp.mazes.algorithms",
    "measures": "analysis",
    "measures.walks": "analysis.metrics",
    "messages": "language.messages",
    "notebook": "render.notebook",
    "packing": "library.packs.build",
    "packs": "library.packs",
    "packs.carried": "library.packs.known",
    "packs.errors": "library.packs.format",
    "packs.installed": "library.packs.known",
    "packs.lock": "library.packs.store",
    "packs.manifest": "library.packs.format",
    "packs.paths": "library.packs.format",
    "places": "library.search_path",
    "plain": "language.plain_data",
    "reading": "library.reading",
    "render.animation": "render.gif",
    "render.ansi": "render.text",
    "render.canvas": "render.notebook.canvas",
    "render.flatten": "render.raster",
    "render.link": "render.page",
    "render.numbers": "render.text",
    "render.packed": "render.page_shapes",
    "render.pagedata": "render.page_data",
    "render.pen": "render.raster",
    "render.playable": "render.page_data",
    "render.screen": "render.scene.shapes",
    "render.stage": "render.notebook.canvas",
    "render.textframes": "render.text",
    "report": "lint.reporters",
    "report.json": "lint.reporters",
    "resolve": "mdp.drawn",
    "sb3": "envs.sb3",
    "scene": "render.scene",
    "scene.figure": "render.scene.robot",
    "scene.lines": "render.scene.layout",
    "scene.overlays": "render.scene.overlay",
    "scene.paths": "render.scene.shapes",
    "scene.puddles": "render.scene.ground",
    "scene.runs": "language.runs",
    "scene.told_policy": "render.scene.info",
    "scene.told_rows": "render.scene.info",
    "schema": "language.json_schema",
    "share": "language.share_code",
    "share_dictionary": "language.share_dictionary",
    "solver": "analysis.solver",
    "solver.errors": "analysis.solver.results",
    "solver.graphs": "analysis.solver.model",
    "solver.loops": "analysis.solver.optimum",
    "solver.simulation": "analysis.solver.evaluation",
    "source": "text.source",
    "spec": "language",
    "spec.color": "language.looks",
    "spec.ends": "language.checks",
    "spec.geometry": "language.checks",
    "spec.problem": "text.diagnostics",
    "spec.rules": "language.checks",
    "starter": "generate.starter",
    "suggest": "text.words",
    "suites": "generate.suites",
    "syntax": "text",
    "syntax.layout": "text.emitter",
    "themes": "language.documents",
}
"""The modules and packages that have moved, old name to new. The longest entry for a name counts.

An entry covers the modules below it as well. Both are names below `babyrobot_levels`.
"""


def install() -> None:
    """Serve the old names from now on. Can be called again."""
    if not any(isinstance(finder, _Finder) for finder in sys.meta_path):
        # At the front: below an old name that stands for a package, the usual finder would find
        # the package's files and load them a second time.
        sys.meta_path.insert(0, _Finder())


def new_name(old: str) -> str | None:
    """Return the full name of the module that had the full name `old`; None if it has no other."""
    if not old.startswith(_PACKAGE):
        return None
    parts = old.split(".")[1:]
    for count in range(len(parts), 0, -1):
        new = MOVED.get(".".join(parts[:count]))
        if new is not None:
            return ".".join(["babyrobot_levels", new, *parts[count:]])
    return None


class _Finder:
    """Finds a module under its old name by importing it under its new one."""

    def find_spec(
        self, fullname: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        new = new_name(fullname)
        if new is None:
            return None
        message = f"the module {fullname} is now {new}"
        warnings.warn(message, DeprecationWarning, stacklevel=2)
        return ModuleSpec(fullname, _Loader(new))  # type: ignore[arg-type]


class _Loader:
    """Gives the module that is imported under its new name."""

    def __init__(self, name: str):
        self._name = name

    def create_module(self, spec: ModuleSpec) -> ModuleType:
        module = importlib.import_module(self._name)
        self._spec = module.__spec__
        return module

    def exec_module(self, module: ModuleType) -> None:
        # The import system has put the spec of the old name in its place.
        module.__spec__ = self._spec
