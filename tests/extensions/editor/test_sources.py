"""What the editor opens, saves and copies."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import pytest
from support.gestures import send

import babyrobot_levels as brl
from babyrobot_levels.extensions.editor.session import Session
from babyrobot_levels.extensions.editor.sources import session_of

TEXT = """\
# A small level.
version: 1
size: [3, 2]  # columns, rows
start: [0, 0]
exit: [2, 1]
"""
OTHER = TEXT.replace("[3, 2]", "[3, 3]")


def error_of(session: Session, do: str, **fields: Any) -> str:
    """Send a message that is to be refused, and return why; nothing changes."""
    before = session.text, session.is_saved
    error = send(session, do, **fields)["error"]
    assert (session.text, session.is_saved) == before
    assert isinstance(error, str)
    return error


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "small.yaml"
    path.write_text(TEXT, "utf-8")
    return path


# -- opening ---------------------------------------------------------------------------------


def test_a_file_is_edited_in_its_place(file: Path) -> None:
    session = session_of(file)
    assert (session.text, session.path, session.is_saved) == (TEXT, file, True)


def test_a_file_need_not_be_valid_nor_exist(tmp_path: Path) -> None:
    (tmp_path / "bad.yaml").write_text("version: 1\nsize: [", "utf-8")
    assert not session_of(tmp_path / "bad.yaml").is_valid
    new = session_of(tmp_path / "new.yaml")
    assert new.is_valid
    send(new, "save")
    assert (tmp_path / "new.yaml").read_text("utf-8") == new.text


def test_a_new_level_has_no_findings() -> None:
    session = session_of(None)
    assert [*session.report.diagnostics] == []
    assert brl.format(session.text) == session.text


def test_levels_of_the_project_have_files_and_those_of_the_gallery_are_copies(here: Path) -> None:
    (here / "levels").mkdir()
    (here / "levels" / "own.yaml").write_text(TEXT, "utf-8")
    assert session_of("own").path == (here / "levels" / "own.yaml").resolve()
    copy = session_of("gallery/final-maze")
    assert (copy.path, copy.name) == (None, "final-maze")
    assert copy.text.startswith("version: 1\n")
    assert brl.loads(copy.text).digest == brl.load("final-maze").digest
    assert "no file" in error_of(copy, "save")


def test_share_codes_and_levels_of_python_are_copies() -> None:
    level = brl.load("first-key")
    for opened in (session_of(level.share_code()), session_of(level)):
        assert opened.path is None
        assert opened.level is not None
        assert opened.level.digest == level.digest


def test_a_theme_in_a_file_of_its_own_goes_with_a_copy(tmp_path: Path) -> None:
    (tmp_path / "themes").mkdir()
    theme = 'colors: {base: "#eeeeee"}\n'
    (tmp_path / "themes" / "pale.yaml").write_text(theme, "utf-8")
    (tmp_path / "themed.yaml").write_text(TEXT + "theme: pale\n", "utf-8")
    level = brl.load(tmp_path / "themed.yaml")
    session = session_of(level)
    assert session.level is not None
    assert session.level.resolved_theme == level.resolved_theme


@pytest.mark.parametrize(
    ("source", "expected"),
    [
        ("final-maze", brl.load("final-maze")),
        (brl.load("final-maze").share_code(), brl.load("final-maze")),
        (TEXT, brl.loads(TEXT)),
        ("SFFF\nFHFH\nFFFH\nHFFG\n", brl.load("frozen-lake")),
        ("{'width': 8}", brl.from_setup({"width": 8})),
    ],
)
def test_another_level_is_opened_as_one_step(source: str, expected: brl.Level) -> None:
    session = session_of(None)
    before = session.text
    reply = send(session, "open", source=source)
    assert "error" not in reply
    assert session.level is not None
    assert session.level.size == expected.size
    send(session, "undo")
    assert session.text == before


@pytest.mark.parametrize(
    ("source", "said"),
    [
        ("final-mace", "final-maze"),
        ("../../../etc/passwd", "no level"),
        ("brl1.24.R4BZv8", "share code"),
        ("what a day\nit is", "no map"),
        ("", "blank"),
        ("#####\n#S E#\n#####\n", "choose the format"),
    ],
)
def test_what_cannot_be_opened_is_said(source: str, said: str) -> None:
    assert said in error_of(session_of(None), "open", source=source)


def test_an_invalid_text_can_be_pasted() -> None:
    session = session_of(None)
    assert "error" not in send(session, "open", source="version: 1\nsize: [3\n")
    assert not session.is_valid


def test_what_is_opened_in_a_file_is_saved_to_that_file(file: Path) -> None:
    session = session_of(file)
    send(session, "open", source="final-maze")
    assert not session.is_saved
    send(session, "save")
    assert brl.load(file).digest == brl.load("final-maze").digest


# -- saving ----------------------------------------------------------------------------------


@pytest.mark.parametrize("mark", ["", "\ufeff"])
def test_saving_writes_the_text_and_keeps_line_ends_and_mark(file: Path, mark: str) -> None:
    file.write_bytes((mark + TEXT.replace("\n", "\r\n")).encode())
    session = session_of(file)
    send(session, "text", text=OTHER)
    assert not session.is_saved
    reply = send(session, "save")
    assert reply["state"]["is_saved"] is True
    assert file.read_bytes() == (mark + OTHER.replace("\n", "\r\n")).encode()
    send(session, "text", text=TEXT)
    assert "error" not in send(session, "save")


def test_an_invalid_text_can_be_saved(file: Path) -> None:
    session = session_of(file)
    send(session, "text", text="version: 1\nsize: [")
    assert "error" not in send(session, "save")
    assert file.read_text("utf-8") == "version: 1\nsize: ["


@pytest.mark.parametrize("meanwhile", [OTHER.encode(), b"", b"\xff\xfe", None])
def test_what_another_program_wrote_is_overwritten_only_on_demand(
    file: Path, meanwhile: bytes | None
) -> None:
    session = session_of(file)
    send(session, "text", text=TEXT + "max_steps: 7\n")
    if meanwhile is None:
        file.unlink()
    else:
        file.write_bytes(meanwhile)
    reply = send(session, "save")
    assert reply["conflict"]
    assert "another program" in reply["error"]
    assert meanwhile == (file.read_bytes() if file.exists() else None)
    assert "error" not in send(session, "save", force=True)
    assert file.read_text("utf-8") == session.text
    assert "error" not in send(session, "save")


def test_a_new_file_that_another_program_made_first_is_a_conflict(tmp_path: Path) -> None:
    session = session_of(tmp_path / "new.yaml")
    (tmp_path / "new.yaml").write_text(OTHER, "utf-8")
    assert send(session, "save")["conflict"]
    assert (tmp_path / "new.yaml").read_text("utf-8") == OTHER


@pytest.mark.slow
def test_what_is_undone_and_done_again_is_told() -> None:
    session = Session(TEXT)
    send(session, "walls", at=[0, 0], side="E", to="wall")
    send(session, "text", text=TEXT + "max_steps: 9\n")
    assert [send(session, "undo")["step"] for _ in range(3)] == ["text", "walls", None]
    assert [send(session, "redo")["step"] for _ in range(3)] == ["walls", "text", None]


def test_the_text_of_another_program_is_taken_on_demand_and_can_be_undone(file: Path) -> None:
    session = session_of(file)
    send(session, "text", text=TEXT + "max_steps: 7\n")
    file.write_text(OTHER, "utf-8")
    assert send(session, "reload")["state"]["is_saved"] is True
    assert session.text == OTHER
    send(session, "undo")
    assert session.text == TEXT + "max_steps: 7\n"
    file.unlink()
    assert "does not exist" in error_of(session, "reload")


def test_a_file_behind_a_link_is_written_and_the_link_stays(file: Path, tmp_path: Path) -> None:
    link = tmp_path / "link.yaml"
    link.symlink_to(file)
    session = session_of(link)
    send(session, "text", text=OTHER)
    send(session, "save")
    assert link.is_symlink()
    assert file.read_text("utf-8") == OTHER


@pytest.mark.parametrize("force", [False, True])
def test_a_file_that_became_a_link_is_not_followed(file: Path, tmp_path: Path, force: bool) -> None:
    secret = tmp_path / "secret"
    secret.write_text(TEXT, "utf-8")
    session = session_of(file)
    send(session, "text", text=OTHER)
    file.unlink()
    file.symlink_to(secret)
    assert "link" in error_of(session, "save", force=force)
    assert secret.read_text("utf-8") == TEXT


@pytest.mark.parametrize("force", [False, True])
def test_a_folder_or_a_pipe_in_its_place_is_not_written(file: Path, force: bool) -> None:
    session = session_of(file)
    send(session, "text", text=OTHER)
    file.unlink()
    file.mkdir()
    assert "directory" in error_of(session, "save", force=force)
    file.rmdir()
    os.mkfifo(file)
    assert "regular" in error_of(session, "save", force=force)


@pytest.mark.skipif(os.geteuid() == 0, reason="the superuser may write everything")
def test_a_file_that_may_not_be_written_is_not(file: Path) -> None:
    session = session_of(file)
    send(session, "text", text=OTHER)
    file.chmod(0o444)
    assert "read-only" in error_of(session, "save")
    file.chmod(0o644)
    file.parent.chmod(0o555)
    assert "Permission denied" in error_of(session, "save")
    file.parent.chmod(0o755)


def test_a_full_disk_leaves_the_file_as_it_was(file: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    session = session_of(file)
    send(session, "text", text=OTHER)

    def full(descriptor: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    assert "No space left" in error_of(session, "save")
    assert file.read_text("utf-8") == TEXT
    assert [*file.parent.iterdir()] == [file]


# -- copying ---------------------------------------------------------------------------------


@pytest.mark.slow
def test_a_level_is_copied_in_every_form(file: Path) -> None:
    session = session_of("gallery/final-maze")
    level = brl.load("final-maze")
    made = {form: send(session, "copy", form=form)["copy"] for form in ("yaml", "drawing", "code")}
    assert made["yaml"] == session.text
    assert made["drawing"] == level.draw()
    assert brl.load(made["code"]).digest == level.digest
    names: dict[str, Any] = {}
    exec(send(session, "copy", form="python")["copy"], names)
    assert names["level"].digest == level.digest
    link = send(session, "copy", form="link")["copy"]
    assert brl.load(f"https://example.org/play.html{link}").digest == level.digest


def test_python_code_holds_every_text() -> None:
    text = TEXT + 'title: \'a \\ b """ c "\'\n'
    names: dict[str, Any] = {}
    exec(send(Session(text), "copy", form="python")["copy"], names)
    assert names["level"].title == 'a \\ b """ c "'


def test_a_text_with_errors_is_only_copied_as_it_is() -> None:
    session = Session("version: 1\nsize: [")
    assert send(session, "copy", form="yaml")["copy"] == session.text
    for form in ("drawing", "python", "code", "link"):
        assert "errors" in error_of(session, "copy", form=form)
    assert "not known" in error_of(session, "copy", form="docx")


# -- ending ----------------------------------------------------------------------------------


def test_unsaved_changes_are_told_before_the_end(file: Path) -> None:
    session = session_of(file)
    assert send(session, "quit") == {"id": 1, "ended": True}
    send(session, "text", text=OTHER)
    assert send(session, "quit")["unsaved"] is True
    assert send(session, "quit", force=True)["ended"] is True
    send(session, "save")
    assert send(session, "quit")["ended"] is True
