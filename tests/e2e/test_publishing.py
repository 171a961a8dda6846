"""What publishes the project: workflows, the citation, and the notes of a release."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest
import yaml
from support.places import ROOT

import babyrobot_levels as brl

WORKFLOWS = sorted((ROOT / ".github" / "workflows").glob("*.yml"))
SCRIPT = ROOT / "scripts" / "release_notes.py"


def schema_check(schema: str, *files: Path) -> str:
    """Return what a schema that the checker brings along finds in files."""
    command = [sys.executable, "-m", "check_jsonschema", "--builtin-schema", f"vendor.{schema}"]
    done = subprocess.run([*command, *files], capture_output=True, text=True, check=False)
    return "" if done.returncode == 0 else done.stdout + done.stderr


@pytest.mark.sweep
def test_the_workflows_and_the_citation_are_valid() -> None:
    assert {path.stem for path in WORKFLOWS} == {"check", "pages", "release"}
    assert schema_check("github-workflows", *WORKFLOWS) == ""
    assert schema_check("citation-file-format", ROOT / "CITATION.cff") == ""


@pytest.mark.parametrize("path", WORKFLOWS, ids=lambda path: path.stem)
def test_workflows_pin_what_they_use_and_grant_each_job_what_it_needs(path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    used = re.findall(r"\buses:(.*)", text)
    assert used
    assert [
        each for each in used if not re.fullmatch(r" [\w./-]+@[0-9a-f]{40} # v\d+\.\d+\.\d+", each)
    ] == []
    workflow = yaml.safe_load(text)
    assert workflow["permissions"] == {}
    assert all("permissions" in job for job in workflow["jobs"].values())


def test_the_citation_is_of_this_version() -> None:
    path = ROOT / "CITATION.cff"
    assert yaml.safe_load(path.read_text(encoding="utf-8"))["version"] == brl.__version__


def test_the_checks_on_github_are_those_of_the_script() -> None:
    steps = re.findall(r"check\.sh (\w+)", (ROOT / ".ci" / "run").read_text(encoding="utf-8"))
    text = (ROOT / ".github" / "workflows" / "check.yml").read_text(encoding="utf-8")
    matrix = yaml.safe_load(text)["jobs"]["others"]["strategy"]["matrix"]
    assert sorted(matrix["step"]) == sorted([*steps, "alone", "sweep"])


def project(folder: Path, changelog: str, version: str = "1.2.0") -> Path:
    """Make the files of which release notes are made, and return the script among them."""
    (folder / "babyrobot_levels").mkdir()
    (folder / "scripts").mkdir()
    (folder / "babyrobot_levels" / "__init__.py").write_text(f'__version__ = "{version}"\n')
    (folder / "CITATION.cff").write_text(f"version: {version}\n")
    (folder / "CHANGELOG.md").write_text(f"# Changelog\n\n{changelog}")
    script = folder / "scripts" / SCRIPT.name
    script.write_bytes(SCRIPT.read_bytes())
    return script


def notes(script: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, str(script), *arguments]
    return subprocess.run(command, capture_output=True, text=True, check=False)


def test_the_notes_of_a_release_are_the_section_of_its_version(tmp_path: Path) -> None:
    text = "## Unreleased\n\nSoon.\n\n## 1.2.0 - 2026-12-01\n\n### Added\n\n- A door.\n\n## 1.1.0\n"
    done = notes(project(tmp_path, text), "1.2.0")
    assert (done.returncode, done.stdout) == (0, "### Added\n\n- A door.\n")


@pytest.mark.parametrize(
    ("changelog", "version", "said"),
    [
        ("## Unreleased\n", "1.2.0", "CHANGELOG.md has no section `## 1.2.0`"),
        ("## 1.3.0\n", "1.3.0", "the version in babyrobot_levels/__init__.py is 1.2.0, not 1.3.0"),
    ],
)
def test_a_release_that_is_not_prepared_is_refused(
    tmp_path: Path, changelog: str, version: str, said: str
) -> None:
    done = notes(project(tmp_path, changelog), version)
    assert done.returncode == 1
    assert done.stdout == ""
    assert said in done.stderr
