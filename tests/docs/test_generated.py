"""What is generated is as the command that renews it would write it."""

from __future__ import annotations

from pathlib import Path

import pytest
import renew
from renew import GENERATED, ROOT, Generated

ELSEWHERE = {
    "tests/cli/expected/*.txt",
    "tests/levels/bad/*.txt",
    "tests/render/golden/*.svg",
    # Its sizes may age a little.
    "docs/images/structure.svg",
    # Its bytes depend on the version of Pillow.
    "docs/images/final-maze.gif",
}
"""What tests of its room compare."""

COMPARED = [
    each
    for each in GENERATED
    if not each.needs and each.paths[0] not in ELSEWHERE and ".png" not in each.paths[0]
]


SLOW = {"docs/images/scores.svg", "docs/images/things*.svg", "docs/mazes.md"}


@pytest.mark.parametrize(
    "generated",
    [
        pytest.param(
            each, marks=pytest.mark.slow if each.paths[0] in SLOW else (), id=each.paths[0]
        )
        for each in COMPARED
    ],
)
def test_it_is_up_to_date(generated: Generated) -> None:
    for path, make in generated.files():
        assert make() == (ROOT / path).read_text("utf-8"), f"python scripts/renew.py {path}"


@pytest.mark.parametrize("generated", GENERATED, ids=lambda each: each.paths[0])
def test_each_file_is_there_once_and_no_other_is(generated: Generated) -> None:
    for path, _ in generated.files():
        owners = [each for each in GENERATED if any(Path(path).match(glob) for glob in each.paths)]
        assert owners[0] is generated or generated.paths[0] == "notebooks/jax.ipynb"
        assert (ROOT / path).exists(), f"python scripts/renew.py {path}"
    assert renew.stale(generated) == []


def test_what_is_named_is_written_where_it_differs(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    renew.renew(["schemas", "docs/images/things.svg"], tmp_path)
    files = sorted(path.relative_to(tmp_path).as_posix() for path in tmp_path.rglob("*.*"))
    assert files[0] == "docs/images/things.svg"
    assert {path.rpartition("/")[0] for path in files[1:]} == {"schemas"}
    assert sorted(capsys.readouterr().out.split()) == files
    (tmp_path / files[0]).write_text("old")
    renew.renew(["schemas", "docs/images/things.svg"], tmp_path)
    assert capsys.readouterr().out.split() == files[:1]
    assert (tmp_path / files[0]).read_text("utf-8") == (ROOT / files[0]).read_text("utf-8")
