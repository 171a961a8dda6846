"""The runner of the documentation's pages finds what does not run, and what is not as shown."""

from __future__ import annotations

import re
import sys
from pathlib import Path

import pytest
from support.each import for_each
from support.pages import all_pages, blocks_of, blocks_with, run_page
from support.places import ROOT

BIN = Path(sys.executable).parent
LANGUAGES = {"", "console", "json", "python", "sh", "text", "toml", "vim", "yaml"}


def faults(tmp_path: Path, page: str, *extras: str) -> list[str]:
    path = tmp_path / "page.md"
    path.write_text(page, encoding="utf-8")
    return [
        fault.removeprefix(f"{path.as_posix()}:")
        for fault in run_page(blocks_of(path), BIN, set(extras), str(ROOT))
    ]


# -- what is right ---------------------------------------------------------------------------


@pytest.mark.slow
def test_blocks_are_done_in_one_folder_in_their_order(tmp_path: Path) -> None:
    page = """\
<!-- file: levels/my.yaml -->
```yaml
version: 1
```

```sh
echo 3 > number  # a comment
```

```python
from pathlib import Path

int(Path("number").read_text())  # 3: as written
print(Path("levels/my.yaml").read_text())

# version: 1
```

```console
$ cat number \\
> levels/my.yaml
3
version: 1
$ for number in 1 2 3 4; do echo "line $number"; done
…
line 3
line …
$ ls nowhere
ls: …
$ echo "wrote maze.svg (12.3 KB)"
wrote maze.svg (9 bytes)
```

<!-- in the clone -->
```sh
test -f pyproject.toml
```
"""
    assert faults(tmp_path, page) == []


def test_what_needs_more_or_cannot_be_run_is_left_out(tmp_path: Path) -> None:
    page = """\
<!-- needs: sb3 -->
```sh
exit 3
```

<!-- not run: it asks -->
```sh
exit 4
```
"""
    assert faults(tmp_path, page) == []
    assert len(faults(tmp_path, page, "sb3")) == 1


# -- what is wrong ---------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("block", "fault"),
    [
        ("```sh\ntrue\nls nowhere\n```", "ls nowhere failed"),
        ("```sh\nls nowhere | cat\n```", "failed"),
        ("```console\n$ ls nowhere\n```", "`ls nowhere` fails with the exit status 2"),
        ("```console\n$ ls nowhere\n…\n```", "`ls nowhere` fails with the exit status 2"),
        ("```console\n$ echo one\ntwo\n```", "`echo one` does not print what is shown"),
        ("```console\n$ echo one\n```", "`echo one` does not print what is shown"),
        ("```console\necho one\n```", "begins with"),
        ("```console\n$ exit\n$ echo one\none\n```", "ends early"),
        ("```python\n1 / 0\n```", 'page.md", line 2, in <module>'),
        ("```python\n1 + 1  # 3: two\n```", "line 2: the comment says '3: two', but"),
        ("```python\n2 / 3  # 0.65…\n```", "but the value is 0.66"),
        ('```python\n"ab"  # "b…"\n```', "but the value is 'ab'"),
        ("```python\nprint(2)\n\n# 3\n```", "does not print what its last comment shows"),
        ("<!-- in a clone -->\n```sh\ntrue\n```", "the mark `in a clone` is not known"),
        pytest.param(
            "<!-- in the clone -->\n```sh\npip install '.[unheard]' | grep WARN\nfalse\n```",
            "does not provide the extra 'unheard'",
            marks=pytest.mark.slow,
        ),
    ],
)  # fmt: skip
def test_a_fault_is_found(block: str, fault: str, tmp_path: Path) -> None:
    (found,) = faults(tmp_path, block + "\n")
    assert found.startswith("2: " if block.startswith("<!--") else "1: ")
    assert fault in found


def test_blocks_that_need_extras_come_with_files_and_commands_before_them(tmp_path: Path) -> None:
    page = tmp_path / "page.md"
    page.write_text(
        """\
<!-- file: my.yaml -->
```yaml
```
```python
1
```
```sh
2
```
<!-- needs: sb3 -->
```python
3
```
<!-- needs: ray -->
```python
4
```
```sh
5
```
"""
    )
    assert [each.line for each in blocks_with(page, {"sb3"})] == [2, 7, 11]
    assert not blocks_with(page, {"jax"})


# -- the pages -------------------------------------------------------------------------------


@for_each("page", all_pages(), ids=str)
def test_no_block_is_in_a_language_of_which_the_runner_knows_nothing(page: Path) -> None:
    found = {block.language for block in blocks_of(page)}
    assert {each for each in found if not each.startswith("{")} <= LANGUAGES


def test_some_step_runs_the_blocks_of_each_extra() -> None:
    script = (ROOT / "scripts" / "check.sh").read_text(encoding="utf-8")
    found = re.findall(r"^ +(?:beside_)?pages \S+ (\S+)", script, re.MULTILINE)
    there = {name for names in found for name in names.split(",")}
    needed = {name for page in all_pages() for block in blocks_of(page) for name in block.needs}
    assert needed <= there
