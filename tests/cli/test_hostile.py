"""Whatever a command is fed, it answers in its own words: never a traceback, nothing executed."""

from __future__ import annotations

import os
import sys
import zipfile
from pathlib import Path

import pytest
from support.sessions import babyrobot, environment, run_there

from babyrobot_levels.text import files, reader

LONG = "x" * 300 + ".yaml"
ESCAPE = "\x1b]0;owned\x07\x1b[31m\x9b1m\u202e\r"


pytestmark = pytest.mark.usefixtures("here")

BYTES = {
    "binary": bytes(range(256)) * 20,
    "zeros": b"\0" * 5000,
    "nul": b"version: 1\0\n",
    "empty": b"",
    "utf16": "version: 1".encode("utf-16"),
    "deep": b"[" * 100_000,
    "aliases": b"a: &a [x, x]\nb: &b [*a, *a, *a, *a, *a, *a]\n" + b"c: [*b, *b, *b, *b]\n",
    "endless": b"a: &a [*a]",
    "large": b"# " + b"x" * (2 << 20),
    "number": b"version: " + b"9" * 10_000,
    "tag": b"version: !!python/object/apply:os.system ['touch owned']",
    "cr": b"version: 2\rsize: 3\r",
    "surrogate": b"version: 1\ntitle: \xed\xa0\x80\n",
}


@pytest.mark.parametrize("name", BYTES)
def test_files_that_hold_no_level(name: str) -> None:
    Path("level.yaml").write_bytes(BYTES[name])
    for command in ("validate", "preview", "show"):
        result = babyrobot(command, "level.yaml")
        assert result.status == 1
        assert "level.yaml:" in result.out + result.err
        assert not Path("owned").exists()
    assert babyrobot("validate", "-", given=BYTES[name]).status == 1


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="needs named pipes and links")
@pytest.mark.parametrize("command", ["validate", "preview", "show"])
def test_places_that_are_no_files(command: str) -> None:
    for name in ("empty", "folder.yaml"):
        Path(name).mkdir()
    Path("broken.yaml").symlink_to("nowhere.yaml")
    Path("circle.yaml").symlink_to("circle.yaml")
    os.mkfifo("pipe.yaml")
    Path("here").symlink_to(Path.cwd())
    Path("level.yaml").write_text("version: 1\n", encoding="utf-8")
    names = ["missing.yaml", "empty", "folder.yaml", "broken.yaml", "circle.yaml", "pipe.yaml"]
    for path in (*names, "/dev/zero", "level.yaml/level.yaml"):
        result = babyrobot(command, path)
        assert result.status in (1, 2)
        assert result.out + result.err


def test_folders_that_hold_themselves_are_searched_once() -> None:
    Path("a.yaml").write_text("version: 1\n", encoding="utf-8")
    Path("here").symlink_to(Path.cwd())
    assert babyrobot("validate", ".").out == "1 file checked, valid\n"


@pytest.mark.skipif(sys.platform == "win32", reason="needs links")
def test_links_lead_to_no_other_files_of_the_machine() -> None:
    secret = Path.cwd() / "secret"
    secret.write_text("token: hidden\n", encoding="utf-8")
    levels = Path("levels")
    (levels / "themes").mkdir(parents=True)
    (levels / "level.yaml").write_text("version: 1\ntheme: x\n", encoding="utf-8")
    link = levels / "themes" / "x.yaml"
    for target in (Path("../../secret"), secret):
        link.symlink_to(target)
        for command in ("lint", "preview"):
            done = babyrobot(command, "levels/level.yaml")
            assert done.status == 1
            assert "x.yaml:1:1: error BR101: this link leads out of the folder" in (
                done.out + done.err
            )
            assert "hidden" not in done.out + done.err
        link.unlink()
    (levels / "sea.yaml").write_text("colors: {base: red}\n", encoding="utf-8")
    link.symlink_to("../sea.yaml")
    assert babyrobot("validate", "levels/level.yaml").status == 0
    link.unlink()
    # Of a pack, the folder is that of the pack.
    link.symlink_to("../../sea.yaml")
    (levels / "sea.yaml").rename("sea.yaml")
    assert babyrobot("validate", "levels/level.yaml").status == 1
    Path("pack.yaml").write_text("name: mine\nversion: 1.0.0\n", encoding="utf-8")
    assert babyrobot("validate", "levels/level.yaml").status == 0
    link.unlink()
    (levels / "linked.yaml").symlink_to(secret)
    for command in ("lint", "solve"):
        done = babyrobot(command, "levels")
        assert (done.status, done.out) == (2, "")
        assert (
            done.err == f"error: this link leads out of the folder: {Path('levels/linked.yaml')}\n"
        )


@pytest.mark.slow
def test_names_that_are_too_long() -> None:
    for call in (
        ("validate", LONG),
        ("preview", LONG),
        ("preview", LONG.removesuffix(".yaml")),
        ("new-level", "first", "-o", LONG),
        ("new-level", "first", "-o", f"{LONG}/first.yaml"),
        ("preview", "default", "-o", LONG + ".txt"),
    ):
        assert babyrobot(*call).status in (1, 2)


@pytest.mark.skipif(sys.platform == "win32", reason="needs links and named pipes")
def test_what_is_not_a_file_is_never_replaced_by_one() -> None:
    Path("circle.yaml").symlink_to("circle.yaml")
    os.mkfifo("pipe.txt")
    for force in ((), ("--force",)):
        assert babyrobot("new-level", "first", "-o", "circle.yaml", *force).status == 2
        assert babyrobot("preview", "default", "-o", "pipe.txt", *force).status == 2
        assert Path("pipe.txt").is_fifo()


TEXTS = {
    "title": f'version: 1\ntitle: "{ESCAPE}"\nauthor: "{ESCAPE}"\ndescription: "{ESCAPE}"\n',
    "source": f'version: 1\nsource: "{ESCAPE}"\nlicense: "{ESCAPE}"\n',
    "unknown field": f'version: 1\n"{ESCAPE}": 1\n',
    "value": f'version: 1\nsize: "{ESCAPE}"\n',
    "word": f'version: 1\npuddles: [{{at: [0, 0], size: "{ESCAPE}"}}]\n',
    "color": f'version: 1\nareas: [{{at: [0, 0], color: "{ESCAPE}"}}]\n',
    "name": f'version: 1\nname: "{ESCAPE}"\n',
    "theme": f'version: 1\ntheme: "{ESCAPE}"\n',
    "legend": f'version: 1\nmap: x\nlegend: {{"{ESCAPE}": {{}}}}\n',
    "duplicate": f'version: 1\n"{ESCAPE}": 1\n"{ESCAPE}": 1\n',
    "drawing": f'version: 1\nmap: "+---+\\n|{ESCAPE}|\\n+---+"\n',
}


def is_harmless(text: str) -> bool:
    """Tell whether a text can neither steer a terminal nor turn the way it is read."""
    return all(character.isprintable() or character == "\n" for character in text)


@pytest.mark.slow
@pytest.mark.parametrize("name", TEXTS)
def test_a_level_cannot_steer_the_terminal(name: str) -> None:
    text = "".join(
        character if character.isprintable() or character == "\n" else f"\\u{ord(character):04x}"
        for character in TEXTS[name]
    )
    Path("levels").mkdir()
    Path("levels", "level.yaml").write_text(text, encoding="utf-8")
    for call in ("validate levels", "preview level", "show level", "list"):
        result = babyrobot(*call.split())
        assert is_harmless(result.out + result.err)


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="such names are not allowed there")
@pytest.mark.parametrize("command", ["validate", "show", "list", "new-level"])
def test_a_file_name_cannot_steer_the_terminal(command: str) -> None:
    Path("levels").mkdir()
    path = Path("levels") / f"{ESCAPE}\n.yaml"
    if command == "new-level":
        result = babyrobot("new-level", "first", "-o", str(path))
    else:
        path.write_text("version: 2\n", encoding="utf-8")
        result = babyrobot(command, *([] if command == "list" else [str(path)]))
    told = result.out + result.err
    assert is_harmless(told)
    assert "\n.yaml" not in told


@pytest.mark.skipif(sys.platform == "win32", reason="names are Unicode there")
def test_a_file_name_that_is_not_utf8() -> None:
    name = os.fsdecode(b"n\xff.yaml")
    Path(name).write_text("version: 2\n", encoding="utf-8")
    for arguments in (["validate", name], ["validate", "--format", "json", "."]):
        assert babyrobot(*arguments).status == 1


@pytest.mark.slow
def test_sizes_at_the_limit() -> None:
    for template in ("grid", "drawing"):
        result = babyrobot("new-level", template, "--size", "1024x1024", "--template", template)
        path = Path("levels") / f"{template}.yaml"
        # What was written is valid, and what would not be is not written.
        assert path.exists() == (result.status == 0)
        if path.exists():
            assert babyrobot("validate", str(path)).status == 0
    assert babyrobot("preview", "levels/grid.yaml", "-o", "grid.txt").status == 0


@pytest.mark.slow
@pytest.mark.parametrize("count", ["20000", "9" * 30])
def test_more_puddles_than_a_file_can_hold(count: str) -> None:
    result = babyrobot("new-level", "wet", "--size", "1024x1024", "--puddles", count)
    assert result.status == 2
    assert "puddles" in result.err
    assert list(Path().iterdir()) == []


@pytest.mark.slow
def test_streams_that_cannot_say_everything() -> None:
    Path("levels").mkdir()
    text = 'version: 1\ntitle: "迷路 🤖"\ntags: [far]\n'
    Path("levels", "far.yaml").write_text(text, encoding="utf-8")
    variables = environment(Path.cwd(), PYTHONIOENCODING="ascii") | {"PYTHONUTF8": "0"}
    result = run_there(["list", "--tag", "far"], variables)
    assert (result.status, result.err) == (0, "")


def test_a_level_that_vanishes(monkeypatch: pytest.MonkeyPatch) -> None:
    """A file may be deleted between the moment it is listed and the moment it is read."""
    path = Path("levels", "short-lived.yaml")
    path.parent.mkdir()
    path.write_text("version: 1\n", encoding="utf-8")
    read = files.read_source

    def vanishing(source: Path, name: str | None = None) -> object:
        path.unlink(missing_ok=True)
        return read(source, name)

    monkeypatch.setattr(reader, "read_source", vanishing)
    monkeypatch.setattr(files, "read_source", vanishing)
    assert babyrobot("preview", "short-lived").status == 1
    path.write_text("version: 1\n", encoding="utf-8")
    assert babyrobot("validate", "levels").status == 1


def test_a_hand_in_forges_no_row_and_widens_none() -> None:
    forged = f"eve\nada     1       1         1{ESCAPE}"
    with zipfile.ZipFile("class.zip", "w") as archive:
        for name in (forged, "x" * 60_000, "ben"):
            archive.writestr(f"{name}/a.brlplay", b"{}")
    for (command, option), rows in {("score", "--level"): 4, ("grade", "--course"): 9}.items():
        out = babyrobot(command, "class.zip", option, "first-key", status=1).out
        assert is_harmless(out)
        assert len(out.splitlines()) == rows
        assert not any(line.startswith("ada") for line in out.splitlines())
        assert max(map(len, out.splitlines())) < 400


def test_hand_ins_that_are_not_there_are_told() -> None:
    for call, told in {
        "score nosuch --level first-key": "there is no file or folder nosuch",
        "score nosuch.zip --level first-key": "there is no file or folder nosuch.zip",
        "score nosuch.brlplay": "there is no file or folder nosuch.brlplay",
    }.items():
        result = babyrobot(*call.split(), status=2)
        assert (result.out, result.err) == ("", f"error: {told}\n")
