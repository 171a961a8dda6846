"""Write generated files anew, those that differ: all of them, or those that are named.

Usage: python scripts/renew.py [PATH ...] [--into FOLDER]

A PATH is a file or a folder, such as `cli.md` or `docs/images`. Read the difference before you
commit it. `--into` writes below another folder than the checkout. What needs packages that are
missing is left out, and told.
"""

from __future__ import annotations

import argparse
import json
import re
import shutil
import sys
import tempfile
from collections.abc import Callable, Iterable, Iterator
from contextlib import chdir, contextmanager
from dataclasses import dataclass
from functools import partial
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

ROOT = Path(__file__).resolve().parents[1]
sys.path += [str(ROOT / "tests"), str(ROOT)]

import doc_pictures as pictures  # noqa: E402
import findings_page  # noqa: E402
import structure  # noqa: E402
import transcripts  # noqa: E402
from command_reference import completion, reference  # noqa: E402
from site_map import llms  # noqa: E402
from support import golden, learned, mistakes, reports, sessions  # noqa: E402

import babyrobot_levels as brl  # noqa: E402
from babyrobot_levels.language.json_schema import SCHEMAS, schema_text  # noqa: E402
from babyrobot_levels.language.looks import Theme  # noqa: E402
from babyrobot_levels.linter.rules import documents  # noqa: E402
from babyrobot_levels.mdp.mazes import ALGORITHMS  # noqa: E402
from babyrobot_levels.render.scene.layout import CELL  # noqa: E402
from babyrobot_levels.render.scene.robot import robot_shapes  # noqa: E402
from babyrobot_levels.render.scene.shapes import Scene  # noqa: E402
from babyrobot_levels.render.svg import to_svg  # noqa: E402

if TYPE_CHECKING:
    from playwright.sync_api import Page

File = tuple[str, Callable[[], str | bytes]]
"""The path of a file in the checkout, and what makes its contents."""


@dataclass(frozen=True)
class Generated:
    """Files that are generated.

    Attributes:
        paths: patterns of their paths; a file that matches one, and is not made, is removed.
        source: what they are made from.
        files: returns the files.
        needs: packages without which they are not made.
    """

    paths: tuple[str, ...]
    source: str
    files: Callable[[], Iterable[File]]
    needs: tuple[str, ...] = ()


# -- texts -------------------------------------------------------------------------------------


def _rules() -> Iterator[File]:
    for name, text in documents().items():
        yield f"docs/rules/{name}", partial(str, text)


def _schemas() -> Iterator[File]:
    for name in SCHEMAS:
        yield f"schemas/{name}.schema.json", partial(schema_text, name)


def _sessions() -> Iterator[File]:
    for path in sorted(sessions.FOLDER.glob("*.txt")):
        yield _below(path), partial(sessions.played, path.read_text("utf-8"))


def _reports() -> Iterator[File]:
    for report, paths in ((reports.report, reports.BAD), (reports.lint_report, reports.LINT_BAD)):
        for path in paths:
            yield _below(path.with_suffix(".txt")), partial(report, path)


def _mistakes() -> Iterator[File]:
    for path in sorted(mistakes.FOLDER.glob("*.txt")):
        yield _below(path), partial(mistakes.told, path.read_text("utf-8"))


def maze_page() -> str:
    """Return the page on mazes, with what is measured of the algorithms."""
    table = r"(?<=\n)\| algorithm \| dead ends .*\n(?:\|.*\n)*"
    return re.sub(table, pictures.maze_table(), _text("docs/mazes.md"))


def editor_page() -> str:
    """Return the page on the editor, with the keys that the front end knows."""
    from babyrobot_levels.render.templates import static

    lines = []
    for group in json.loads(static("extensions/editor/static/keys.json")):
        title = group["title"]
        for keys, what in group["keys"]:
            lines.append(f"| {title} | {keys} | {what} |\n".replace("|  |", "| |"))
            title = ""
    table = r"(?<=\n\| \| key \| what it does \|\n\|---\|---\|---\|\n)(?:\|.*\|\n)*"
    return re.sub(table, lambda _: "".join(lines), _text("docs/editor.md"))


def contributing() -> str:
    """Return CONTRIBUTING.md with the table of what is generated."""
    rows = ["| files | made from | needs |", "|---|---|---|"]
    for each in GENERATED:
        paths, needs = (
            ", ".join(f"`{name}`" for name in part) for part in (each.paths, each.needs)
        )
        rows.append(f"| {paths} | {each.source} | {needs} |".replace("|  |", "| |"))
    table = "".join(f"{row}\n" for row in rows)
    return re.sub(r"\| files \| made from .*\n(?:\|.*\n)*", table, _text("CONTRIBUTING.md"))


def run_notebook(path: Path) -> str:
    """Return the text of a notebook with the outputs of a fresh run.

    Raises:
        CellExecutionError: a cell fails.
    """
    import nbformat
    from jupyter_client.kernelspec import KernelSpecManager
    from jupyter_client.manager import AsyncKernelManager
    from nbclient import NotebookClient

    notebook = nbformat.read(path, as_version=4)  # type: ignore[no-untyped-call]
    # Told no folders, the manager knows only the kernel of the running interpreter.
    kernels = AsyncKernelManager(kernel_spec_manager=KernelSpecManager(kernel_dirs=[]))
    with tempfile.TemporaryDirectory() as empty:
        NotebookClient(
            notebook,
            km=kernels,
            timeout=120,
            record_timing=False,
            coalesce_streams=True,
            resources={"metadata": {"path": empty}},
        ).execute()
    # Nothing depends on who ran it.
    notebook["metadata"] = {
        "kernelspec": {"display_name": "Python 3", "language": "python", "name": "python3"},
        "language_info": {"name": "python"},
    }
    for cell in notebook["cells"]:
        cell["metadata"] = {}
    text: str = nbformat.writes(notebook)  # type: ignore[no-untyped-call]
    return text + "\n"


def _notebooks(*, with_jax: bool) -> Iterator[File]:
    for path in sorted(ROOT.glob("notebooks/*.ipynb")):
        if (path.stem == "jax") == with_jax:
            yield _below(path), partial(run_notebook, path)


# -- pictures ----------------------------------------------------------------------------------


def _golden() -> Iterator[File]:
    for name in golden.pictures():
        yield _below(golden.FOLDER / f"{name}.svg"), partial(golden.svg, name)
    yield _below(golden.FOLDER / "gallery.txt"), golden.gallery


def _mazes() -> Iterator[File]:
    for name in ALGORITHMS:
        yield f"docs/images/mazes/{name}.svg", partial(pictures.maze, name)
    yield "docs/images/mazes/depth-first-loops.svg", partial(pictures.maze, "depth-first", 1.0)


def _things() -> Iterator[File]:
    yield "docs/images/things.svg", pictures.things
    yield "docs/images/things-held.svg", partial(pictures.things, "key", "lever")


def _answers() -> Iterator[File]:
    for name in pictures.ANSWERED:
        yield f"docs/images/answers/{name}.png", partial(pictures.answer, name)
    yield "docs/images/answers/maze-64.png", partial(pictures.large_answer, 64)


def _maze() -> str:
    return brl.load("final-maze").to_svg()


def _walk() -> bytes:
    return brl.load("final-maze").to_gif(seed=3)


def _scores() -> str:
    """Return the picture that a block of the page on scores makes."""
    blocks = re.findall(r"```python\n(.*?)```", _text("docs/scoring.md"), re.S)
    with tempfile.TemporaryDirectory() as folder, chdir(folder):
        exec(next(block for block in blocks if "scores.svg" in block), {})
        return Path("scores.svg").read_text("utf-8")


def _robot() -> str:
    return to_svg(Scene(CELL, CELL, robot_shapes(Theme(), 0, 0)))


def _rooms() -> str:
    return structure.picture(structure.rooms_to_draw(structure.Structure(ROOT)))


@contextmanager
def _page(width: int, height: int) -> Iterator[Page]:
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        system = shutil.which("chromium") or shutil.which("chromium-browser")
        browser = playwright.chromium.launch(executable_path=system, args=["--no-sandbox"])
        yield browser.new_page(viewport={"width": width, "height": height})
        browser.close()


def _gallery() -> bytes:
    """Return the picture of the gallery of all levels in a browser."""
    with tempfile.TemporaryDirectory() as folder, _page(1280, 840) as page:
        title = "The babyrobot gallery"
        made = brl.gallery("gallery", Path(folder) / "gallery", title=title, jobs=2)
        page.goto((made.folder / "index.html").as_uri())
        page.wait_for_load_state("networkidle")
        return pictures.reduced(page.screenshot(), 256)


def _agent() -> bytes:
    """Return the picture of a page with an agent beside the optimum, as `docs/pictures.md` says."""
    *_, learned = brl.sarsa("cliff-walking", 500, actions="moves", seed=1)
    text = brl.load("cliff-walking").to_html(policy=learned, values=True)
    with _page(1200, 900) as page:
        page.set_content(text)
        page.wait_for_selector("body.ready")
        page.locator("#views label", has_text="Difference").click()
        return pictures.reduced(page.screenshot(), 256)


def _learning() -> Iterator[File]:
    for name in ("q_learning", "sarsa"):
        yield f"docs/images/learn/{name.replace('_', '-')}.png", partial(_learned, name)
    yield "docs/images/learn/while-drawing.png", _while_drawing


def _learned(algorithm: str) -> bytes:
    """Return the picture of a page on which an algorithm has learned for 500 episodes."""
    with _page(1200, 620) as page:
        page.set_content(brl.load("cliff-walking").to_html())
        page.wait_for_selector("body.ready")
        page.keyboard.press("e")
        page.select_option("[data-option=algorithm]", algorithm)
        page.evaluate("() => { while (learning.learner.number < 499) learning.learner.finish(); }")
        page.locator("#stage").focus()
        page.keyboard.press("ArrowDown")
        page.mouse.click(5, 5)
        return pictures.reduced(page.screenshot(), 256)


def _editor() -> bytes:
    """Return the picture of the editor in a browser."""
    from support.editors import is_shown, served

    from babyrobot_levels.extensions.editor.sources import session_of

    with served(session_of("gallery/first-key")) as address, _page(1200, 760) as page:
        page.goto(address)
        is_shown(page)
        page.get_by_role("button", name="Values").click()
        page.wait_for_timeout(1000)
        return page.screenshot()


def _while_drawing() -> bytes:
    """Return the picture of the editor after the shorter way of a level was closed in a run."""
    from support.editors import is_shown, served

    from babyrobot_levels.extensions.editor.session import Session

    level = brl.load("dyna-maze").replace(expect=None)
    closing = [*["ArrowDown"] * 4, "ArrowRight", "m", "ArrowDown", "Shift+ArrowRight"]
    with served(Session(level.to_yaml())) as address, _page(1200, 760) as page:
        page.goto(address)
        is_shown(page)
        page.get_by_role("tab", name="Learn").click()
        page.locator("[data-option=planning_steps]").fill("20")
        page.locator(".stage").focus()
        for key in [*"u" * 60, *closing]:
            page.keyboard.press(key)
        page.locator("#learn-numbers", has_text="exact 0.46").wait_for()
        for key in "u" * 30:
            page.keyboard.press(key)
        page.locator("[data-option=algorithm]").scroll_into_view_if_needed()
        page.wait_for_timeout(1000)
        return pictures.reduced(page.screenshot(), 256)


# -- all of them -------------------------------------------------------------------------------


def _one(path: str, make: Callable[[], str | bytes], source: str, *needs: str) -> Generated:
    return Generated((path,), source, lambda: [(path, make)], needs)


GENERATED = (
    _one("CONTRIBUTING.md", contributing, "its table of generated files, from `scripts/renew.py`"),
    _one("cli.md", reference, "the commands"),
    _one("babyrobot_levels/cli/completion.json", completion, "the commands, and what they take"),
    _one("docs/SKILL.md", brl.skill, "the language, the metrics and the rules"),
    _one("docs/transcripts.md", transcripts.page, "`scripts/transcripts.py`"),
    _one("docs/llms.txt", llms, "the contents of `docs/index.md`"),
    _one("findings/README.md", findings_page.page, "the heads of `findings/*.sh`"),
    Generated(("schemas/*.json",), "the models of files", _schemas),
    Generated(("docs/rules/*.md",), "docstrings of rules", _rules),
    Generated(("tests/cli/expected/*.txt",), "the commands that they name", _sessions),
    Generated(
        ("tests/levels/bad/*.txt", "tests/linter/rules/*/bad-*.txt"),
        "the levels beside them",
        _reports,
    ),
    Generated(("tests/mistakes/*.txt",), "the texts that they hold", _mistakes),
    Generated(
        ("tests/render/golden/*.svg", "tests/render/golden/gallery.txt"),
        "`tests/support/golden.py`",
        _golden,
    ),
    _one("tests/javascript/learned.json", learned.recorded, "`tests/support/learned.py`"),
    _one("docs/mazes.md", maze_page, "its table from what is measured"),
    Generated(("docs/images/mazes/*.svg",), "the maze algorithms", _mazes),
    Generated(("docs/images/things*.svg",), "`scripts/doc_pictures.py`", _things),
    Generated(("docs/images/answers/*.png",), "`scripts/doc_pictures.py`", _answers),
    _one("docs/images/final-maze.svg", _maze, "the level"),
    _one("docs/images/final-maze.gif", _walk, "the level"),
    _one("docs/images/scores.svg", _scores, "`docs/scoring.md`"),
    _one("docs/style/robot.svg", _robot, "the robot of pictures"),
    _one("docs/images/sheet.png", pictures.sheet, "`scripts/doc_pictures.py`"),
    _one("docs/images/structure.svg", _rooms, "imports between rooms"),
    _one("docs/editor.md", editor_page, "its keys from the front end"),
    _one("docs/images/editor.png", _editor, "the editor", "playwright"),
    Generated(("docs/images/learn/*.png",), "pages", _learning, ("playwright",)),
    _one("docs/images/agent.png", _agent, "`docs/pictures.md`", "playwright"),
    _one("docs/images/gallery.png", _gallery, "the gallery", "playwright"),
    Generated(
        ("notebooks/*.ipynb",), "a run of each", partial(_notebooks, with_jax=False), ("nbclient",)
    ),
    Generated(
        ("notebooks/jax.ipynb",), "a run", partial(_notebooks, with_jax=True), ("nbclient", "jax")
    ),
)
"""What is generated, in the order in which it is written."""


def stale(generated: Generated) -> list[Path]:
    """Return the files that are there and not made any more."""
    made = {path for each in GENERATED for path, _ in each.files()}
    found = (path for pattern in generated.paths for path in ROOT.glob(pattern))
    return [path for path in found if _below(path) not in made]


def _below(path: Path) -> str:
    return path.relative_to(ROOT).as_posix()


def _text(name: str) -> str:
    return (ROOT / name).read_text("utf-8")


def renew(wanted: list[str], into: Path) -> None:
    """Write the files that are wanted, or all, where they differ, and tell which these are."""
    for each in GENERATED:
        files = [(path, make) for path, make in each.files() if _is_wanted(path, wanted)]
        missing = [name for name in each.needs if find_spec(name) is None]
        if files and missing:
            print(f"left out {', '.join(each.paths)}: without {', '.join(missing)}")
            continue
        for name, make in files:
            contents = make()
            data = contents.encode() if isinstance(contents, str) else contents
            path = into / name
            if not path.exists() or path.read_bytes() != data:
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_bytes(data)
                print(name)
        for path in stale(each) if into == ROOT else ():
            if _is_wanted(_below(path), wanted):
                path.unlink()
                print(f"{_below(path)}: removed")


def _is_wanted(path: str, wanted: list[str]) -> bool:
    return not wanted or any(path == each or path.startswith(f"{each}/") for each in wanted)


def main() -> int:
    """Write what is wanted."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("paths", nargs="*", type=Path, metavar="PATH", help="files or folders")
    parser.add_argument("--into", type=Path, default=ROOT, metavar="FOLDER", help="write here")
    options = parser.parse_args()
    wanted = [path.as_posix() for path in options.paths]
    made = [path for each in GENERATED for path, _ in each.files()]
    for each in wanted:
        if not any(_is_wanted(path, [each]) for path in made):
            print(f"nothing of {each} is generated", file=sys.stderr)
            return 2
    renew(wanted, options.into.resolve())
    return 0


if __name__ == "__main__":
    sys.exit(main())
