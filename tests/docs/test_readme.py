"""The README says what is so: levels, errors and pictures are ours."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from support.places import DOCS, EXAMPLES, GALLERY_FOLDER, ROOT
from support.subprocesses import python

import babyrobot_levels as brl

README = (ROOT / "README.md").read_text(encoding="utf-8")


def blocks(text: str, language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```", text, re.MULTILINE | re.DOTALL)


@pytest.mark.parametrize("text", blocks(README, "yaml"))
def test_the_levels_of_the_readme_are_valid(text: str) -> None:
    assert brl.validate(text) == []


def test_the_error_of_the_readme_is_what_is_reported(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The message is compared from its place on; the file is made so that the line is the same."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "levels").mkdir()
    path = Path("levels", "first.yaml")
    path.write_text("version: 1\nsize: [8, 5]\nmaze: {seed: 7}\nexit: [9, 4]\n", encoding="utf-8")
    (shown,) = blocks(README, "text")
    assert "\n\n".join(map(str, brl.validate(path))) == shown.strip()


@pytest.mark.parametrize("script", ["demo.sh", "check.sh"])
def test_the_commands_of_the_readme_name_scripts_that_are_there(script: str) -> None:
    assert any(f"bash scripts/{script}" in block for block in blocks(README, "sh"))
    assert (ROOT / "scripts" / script).is_file()


@pytest.mark.slow
def test_the_demo_shows_the_robot_at_the_exit_in_a_few_lines(tmp_path: Path) -> None:
    level = GALLERY_FOLDER / "final-maze.yaml"
    done = python(EXAMPLES / "play.py", str(level), cwd=tmp_path, timeout=120)
    assert (done.returncode, done.stderr) == (0, "")
    lines = done.stdout.splitlines()
    assert len(lines) < 25
    assert re.fullmatch(r"final-maze: at the exit \[5, 4\] after \d+ steps, return -\d+", lines[-2])
    assert lines[-1].endswith("optimal: -36.58")


@pytest.mark.slow
def test_the_demo_plays_every_kind_of_level(tmp_path: Path) -> None:
    for level in ("random-maze", "gridworld-3-5", "treasure-chests", "ice-vault"):
        done = python(EXAMPLES / "play.py", level, cwd=tmp_path, timeout=120)
        assert (done.returncode, done.stderr) == (0, "")


def test_the_demo_names_its_files_and_git_ignores_them() -> None:
    script = (ROOT / "scripts" / "demo.sh").read_text(encoding="utf-8")
    written = re.findall(r"--output (\S+)", script)
    assert written == ["demo.png", "demo.gif"]
    ignored = (ROOT / ".gitignore").read_text(encoding="utf-8").splitlines()
    assert all(name in ignored and name in script.splitlines()[-1] for name in written)


def test_the_readme_counts_the_gallery() -> None:
    files = [path for path in GALLERY_FOLDER.rglob("*.yaml") if path.parent.name != "suites"]
    assert f"the gallery: {len(files)} levels" in README


def anchors_of(page: Path) -> set[str]:
    """Return the anchors that GitHub gives the headings of a page."""
    text = re.sub(r"^```.*?^```", "", page.read_text(encoding="utf-8"), flags=re.M | re.S)
    headings = re.findall(r"^#+ (.*)$", text, re.MULTILINE)
    return {re.sub(r"[^\w -]", "", heading.lower()).replace(" ", "-") for heading in headings}


@pytest.mark.slow
def test_links_lead_somewhere() -> None:
    pages = [*ROOT.glob("*.md"), *DOCS.glob("*.md"), ROOT / "benchmarks" / "README.md"]
    for page in pages:
        text = re.sub(r"^```.*?^```", "", page.read_text(encoding="utf-8"), flags=re.M | re.S)
        for target, anchor in re.findall(r"\]\(([^)#:\s]*)(?:#([^)\s]*))?\)", text):
            path = page.parent / target if target else page
            assert path.exists(), f"{page.name}: {target}"
            if anchor:
                assert anchor in anchors_of(path), f"{page.name}: {target}#{anchor}"


def test_nothing_is_installed_from_where_it_is_not() -> None:
    """Before a release, no index has the package and no tag names a version."""
    pages = [*ROOT.glob("*.md"), *DOCS.glob("*.md"), *EXAMPLES.glob("*.py")]
    for page in pages:
        text = page.read_text(encoding="utf-8")
        assert not re.search(r"pip install ['\"]?babyrobot-levels", text), page.name
        assert "rev: v" not in text, page.name
