"""`brl.lint`: what it takes, which rules it applies, and what it fixes."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import babyrobot_levels as brl
from babyrobot_levels.linter.linting import SettingsError, settings_for
from babyrobot_levels.linter.rules import UnknownRuleError, all_rules, select

pytestmark = pytest.mark.usefixtures("here")
WET = "version: 1\nsize: [3, 1]\nopenings: []\n"


def codes(found: list[brl.Diagnostic]) -> list[str]:
    return [each.code for each in found]


def test_levels_are_linted_in_all_forms() -> None:
    Path("wet.yaml").write_text(WET, encoding="utf-8")
    told = codes(brl.lint(WET))
    assert told
    level = brl.load("wet.yaml")
    for form in (Path("wet.yaml"), "wet.yaml", ["wet.yaml"], level, Path()):
        assert codes(brl.lint(form)) == told, form
    assert set(codes(brl.lint({"version": 1, "size": [3, 1], "openings": []}))) <= set(told)
    assert brl.lint("final-maze") == []


def test_rules_are_selected_and_ignored() -> None:
    told = codes(brl.lint(WET))
    assert brl.lint(WET, ignore=told) == []
    assert codes(brl.lint(WET, select=told[:1])) == told[:1]
    with pytest.raises(
        UnknownRuleError, match=r"`BR5XX`; there are BR501 to .*, all of them by `BR5`"
    ):
        select(["BR5XX"])
    with pytest.raises(UnknownRuleError, match=r"BR999.*codes are BR501 to"):
        brl.lint(WET, select=["BR999"])


def test_files_are_fixed_and_texts_are_not() -> None:
    path = Path("wet.yaml")
    path.write_text(WET, encoding="utf-8")
    assert [each.fix is not None for each in brl.lint(WET, fix=True)].count(True)
    before = brl.lint(path)
    assert path.read_text("utf-8") == WET
    after = brl.lint(path, fix=True)
    assert len(after) < len(before)
    assert path.read_text("utf-8") != WET
    assert brl.lint(path) == after


def test_equal_levels_of_a_folder_are_told() -> None:
    for name in ("a", "b"):
        Path(f"{name}.yaml").write_text("version: 1\nsize: [3, 2]\n", encoding="utf-8")
    found = [each for each in brl.lint(Path()) if each.file == "b.yaml"]
    assert found[0].message.startswith("this level has the same MDP as a.yaml")


def for_file(path: Path) -> set[str]:
    return {rule.code for rule in settings_for(path).rules_for(path)}


DEFAULT = {rule.code for rule in all_rules() if rule.default}
ALL = {rule.code for rule in all_rules()}


def test_without_settings_the_default_rules_run(tmp_path: Path) -> None:
    assert for_file(tmp_path / "x.yaml") == DEFAULT < ALL


@pytest.mark.parametrize(
    ("name", "head"), [("babyrobot.toml", "lint"), ("pyproject.toml", "tool.babyrobot.lint")]
)
def test_settings_are_found_upward(tmp_path: Path, name: str, head: str) -> None:
    (tmp_path / name).write_text(f'[{head}]\nselect = ["BR6"]\nignore = ["side-spelling"]\n')
    found = for_file(tmp_path / "deep" / "deeper" / "x.yaml")
    assert found == {code for code in ALL if code.startswith("BR6")} - {"BR608"}


def test_only_the_nearest_settings_apply(tmp_path: Path) -> None:
    (tmp_path / "babyrobot.toml").write_text('[lint]\nselect = ["BR6"]\n')
    (tmp_path / "deep").mkdir()
    (tmp_path / "deep" / "pyproject.toml").write_text('[tool.babyrobot.lint]\nselect = ["BR503"]\n')
    assert for_file(tmp_path / "deep" / "x.yaml") == {"BR503"}


def test_a_file_without_settings_is_skipped(tmp_path: Path) -> None:
    (tmp_path / "babyrobot.toml").write_text('[lint]\nselect = ["BR503"]\n')
    (tmp_path / "deep").mkdir()
    (tmp_path / "deep" / "pyproject.toml").write_text('[project]\nname = "x"\n')
    assert for_file(tmp_path / "deep" / "x.yaml") == {"BR503"}


def test_rules_can_be_ignored_per_file(tmp_path: Path) -> None:
    (tmp_path / "babyrobot.toml").write_text(
        '[lint]\nselect = ["BR503", "BR608"]\n[lint.per-file-ignores]\n"old/*" = ["BR608"]\n'
    )
    assert for_file(tmp_path / "old" / "x.yaml") == {"BR503"}
    assert for_file(tmp_path / "new" / "x.yaml") == {"BR503", "BR608"}


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('[lint]\nselct = ["BR5"]\n', "did you mean `select`?"),
        ('[lint]\nselect = "BR5"\n', "must be a list of codes"),
        ('[lint]\nselect = ["unreachable-cell"]\n', "did you mean `unreachable-cells`?"),
        ('[lint]\nignore = ["BR999"]\n', "unknown rule `BR999`"),
        ('[lint]\nper-file-ignores = ["x"]\n', "table of lists"),
        ('[lint.per-file-ignores]\n"x" = ["nonsense"]\n', "unknown rule `nonsense`"),
        ("lint = 3\n", "must be a table"),
        ("[lint\n", "cannot be read"),
        ('[lnt]\nselect = ["BR5"]\n', "unknown setting `lnt`; did you mean `lint`?"),
        ('ignore = ["BR5"]\n', "`ignore` belongs in the table `[lint]`"),
    ],
)
def test_invalid_settings_are_reported_with_their_file(
    tmp_path: Path, text: str, message: str
) -> None:
    (tmp_path / "babyrobot.toml").write_text(text)
    with pytest.raises(SettingsError) as caught:
        settings_for(tmp_path / "x.yaml")
    assert message in str(caught.value)
    assert str(tmp_path / "babyrobot.toml") in str(caught.value)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("[tool]\nbabyrobot = 3\n", "`tool.babyrobot` must be a table"),
        ("[tool.babyrobot]\nlint = 3\n", "`lint` must be a table"),
        ("[tool.babyrobot.lnt]\n", "unknown setting `lnt`; did you mean `lint`?"),
        ("[tool.babyrobot]\nselect = []\n", "in the table `[tool.babyrobot.lint]`"),
    ],
)
def test_invalid_settings_in_pyproject_are_reported(
    tmp_path: Path, text: str, message: str
) -> None:
    (tmp_path / "pyproject.toml").write_text(text)
    with pytest.raises(SettingsError, match=re.escape(message)):
        settings_for(tmp_path / "x.yaml")


def test_settings_may_change_while_python_runs(tmp_path: Path) -> None:
    file = tmp_path / "babyrobot.toml"
    for word in ("BR503", "BR6", "ALL"):
        file.write_text(f'[lint]\nselect = ["{word}"]\n')
        assert for_file(tmp_path / "x.yaml") == selected([word], [])
    file.unlink()
    assert for_file(tmp_path / "x.yaml") == DEFAULT


def test_a_byte_order_mark_is_allowed(tmp_path: Path) -> None:
    text = '[lint]\nselect = ["BR503"]\n'
    (tmp_path / "babyrobot.toml").write_text(text, encoding="utf-8-sig")
    assert for_file(tmp_path / "x.yaml") == {"BR503"}


def selected(wanted: list[str] | None, ignore: list[str]) -> set[str]:
    return {rule.code for rule in select(wanted, ignore)}


def test_the_longer_prefix_takes_precedence() -> None:
    play = {code for code in ALL if code.startswith("BR5")}
    assert selected(["ALL"], []) == ALL
    assert selected(["ALL"], ["BR5"]) == ALL - play
    assert selected(["BR503"], ["BR5"]) == {"BR503"}
    assert selected(["BR5"], ["BR503"]) == play - {"BR503"}
    assert selected(["inescapable-state"], ["BR503"]) == {"BR503"}
    assert selected(["inescapable-state"], ["BR503"]) == {"BR503"}
    assert selected(["BR503"], ["inescapable-state"]) == set()
    assert selected(None, ["BR5"]) == DEFAULT - play


def test_too_short_prefixes_match_no_rule() -> None:
    for word in ("", "B", "BR7", "tra"):
        with pytest.raises(UnknownRuleError):
            select([word])


# -- from Python -----------------------------------------------------------------------------


def test_check_applies_the_rules_of_the_project_if_requested(tmp_path: Path) -> None:
    path = tmp_path / "x.yaml"
    path.write_text("version: 1\nopenings: []\n")
    assert brl.validate(path) == []
    assert [each.code for each in brl.lint(path)] == ["BR609"]
    (tmp_path / "deep").mkdir()
    (tmp_path / "deep" / "babyrobot.toml").write_text('[lint]\nignore = ["BR609"]\n')
    other = path.rename(tmp_path / "deep" / "x.yaml")
    assert brl.lint(other) == []
    assert [each.code for each in brl.lint(other.read_text())] == ["BR609"]
    assert [each.code for each in brl.lint("version: 1\nnonsense: 1\n")] == ["BR201"]
