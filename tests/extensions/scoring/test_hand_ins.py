"""What is handed in, in folders and zip files as school systems export them."""

from __future__ import annotations

import io
import zipfile
from pathlib import Path

import pytest
from support.plays import forged, record

import babyrobot_levels as brl
from babyrobot_levels.extensions.scoring import hand_ins as module
from babyrobot_levels.extensions.scoring.hand_ins import hand_ins

LEVEL = {"version": 1, "size": [3, 1], "max_steps": 9, "name": "row"}


@pytest.fixture
def line(tmp_path: Path) -> bytes:
    record(tmp_path / "line.brlplay", LEVEL)
    return (tmp_path / "line.brlplay").read_bytes()


NOTHING, WANTED = "there is no file to grade, but", ": hand in .brlplay files, or a .zip of them"


def zipped(files: dict[str, bytes]) -> bytes:
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in files.items():
            archive.writestr(name, data)
    return out.getvalue()


def found(*paths: Path) -> dict[str, tuple[list[str], list[tuple[str, str]]]]:
    """Return the places of plays and the faults of each player."""
    return {
        each.player: ([place for place, _ in each.entries], each.faults) for each in hand_ins(paths)
    }


def told(line: bytes, player: str) -> bytes:
    """Return a play under a name."""
    return forged(brl.Play.from_line(line), player=player).to_line().encode() + b"\n"


FILES = [
    "Ada Lovelace_1234_assignsubmission_file_/row.brlplay",
    "Ada Lovelace_1234_assignsubmission_file_/deep/in/lake.BRLPLAY",
    "Ada Lovelace_1234_assignsubmission_file_/notes.pdf",
    "babbagecharles_LATE_77_8_row.brlplay",
    "babbagecharles_77_9_lake.brlplay",
    "Eve_99_assignsubmission_file_/notes.pdf",
    "38559-61437 - Grace Hopper - Sep 25, 2026 1105 PM/row.brlplay",
    "38559-61437 - Grace Hopper- Sep 26, 2026 905 AM/lake.brlplay",
]
PLAYERS = {
    "Ada Lovelace": ({"row.brlplay, line 1", "deep/in/lake.BRLPLAY, line 1"}, []),
    "babbagecharles": ({"line 1"}, []),
    "Grace Hopper": ({"row.brlplay, line 1", "lake.brlplay, line 1"}, []),
    "Eve": (set(), [("", f"{NOTHING} notes.pdf{WANTED}")]),
}


def test_exports_of_schools_have_folders_or_files_of_players(tmp_path: Path, line: bytes) -> None:
    aside = {"__MACOSX/Ada/._row.brlplay": b"x"}
    (tmp_path / "class.zip").write_bytes(zipped({**dict.fromkeys(FILES, line), **aside}))
    for name in FILES:
        (tmp_path / "class" / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / "class" / name).write_bytes(line)
    for path in (tmp_path / "class", tmp_path / "class.zip"):
        players = {name: (set(places), faults) for name, (places, faults) in found(path).items()}
        assert players == PLAYERS


def test_two_students_of_one_name_in_an_export_are_a_fault(tmp_path: Path, line: bytes) -> None:
    # In another export, the same student may have another number.
    for export, numbers in {"row": (12, 13), "lake": (57,)}.items():
        names = [f"Ada Lovelace_{each}_assignsubmission_file_/{export}.brlplay" for each in numbers]
        (tmp_path / f"{export}.zip").write_bytes(zipped(dict.fromkeys(names, line)))
    assert found(tmp_path / "lake.zip")["Ada Lovelace"][1] == []
    places, faults = found(tmp_path / "lake.zip", tmp_path / "row.zip")["Ada Lovelace"]
    assert len(places) == 3
    assert faults == [("", "students 12 and 13 have the same name: give them two")]


def test_students_without_names_have_their_numbers(tmp_path: Path, line: bytes) -> None:
    names = [
        "Participant_12_assignsubmission_file_/row.brlplay",
        "B-Participant_13_assignsubmission_file_/row.brlplay",
        "anon_0jR2c_98_row.brlplay",
        "anon_0jR2c_LATE_99_lake.brlplay",
        "anon_Xy1_97_row.brlplay",
        "submission_7/row.brlplay",
        "ada_2_row.brlplay",
    ]
    (tmp_path / "all.zip").write_bytes(zipped(dict.fromkeys(names, line)))
    assert {player: len(places) for player, (places, _) in found(tmp_path / "all.zip").items()} == {
        "Participant_12": 1,
        "B-Participant_13": 1,
        "anon_0jR2c": 2,
        "anon_Xy1": 1,
        "submission_7": 1,
        "ada_2_row": 1,
    }


def test_a_folder_around_those_of_the_players_is_none(tmp_path: Path, line: bytes) -> None:
    files = {f"export_1/submission_{number}/a.brlplay": line for number in (1, 2)}
    (tmp_path / "class.zip").write_bytes(zipped(files))
    assert [*found(tmp_path / "class.zip")] == ["submission_1", "submission_2"]


def test_a_zip_file_of_a_player_is_read_and_none_in_it(tmp_path: Path, line: bytes) -> None:
    own = zipped({"row.brlplay": line, "more/row.brlplay": line, "in.zip": zipped({})})
    (tmp_path / "class.zip").write_bytes(zipped({"ada/plays.zip": own, "ben.zip": own}))
    folder = tmp_path / "class"
    folder.mkdir()
    (folder / "ada.zip").write_bytes(own)
    for path in (tmp_path / "class.zip", folder):
        players = found(path)
        places, faults = players["ada"]
        assert [place.partition(".zip/")[2] for place in places] == [
            "row.brlplay, line 1",
            "more/row.brlplay, line 1",
        ]
        assert faults[0][1] == "a zip file in the zip file of a player is not read"


def test_the_name_in_plays_is_the_players_if_the_file_has_it(tmp_path: Path, line: bytes) -> None:
    folder = tmp_path / "all"
    folder.mkdir()
    names = {
        "Ada-Lovelace-Row": "Ada Lovelace",
        "ada_lovelace_lake": "Ada Lovelace",
        "eve": "Ada",
        "hopper grace": "Hopper, Grace (1906)",
        "mallory": "(Ada)",
    }
    for file, player in names.items():
        (folder / f"{file}.brlplay").write_bytes(told(line, player))
    assert {name: len(places) for name, (places, _) in found(folder).items()} == {
        "Ada Lovelace": 2,
        "eve": 1,
        "Hopper, Grace (1906)": 1,
        "mallory": 1,
    }


def test_bad_files_are_named_and_the_others_read(
    tmp_path: Path, line: bytes, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "MAX_BYTES", 100_000)
    whole = zipped({"x.brlplay": line})
    encrypted = bytearray(whole)
    for mark, at in ((b"PK\3\4", 6), (b"PK\1\2", 8)):
        encrypted[whole.index(mark) + at] |= 1
    broken = bytearray(whole)
    broken[60:90] = bytes(30)
    path = tmp_path / "class.zip"
    path.write_bytes(
        zipped(
            {
                "ada/a.brlplay": line,
                "ada/../../up.brlplay": line,
                "/root.brlplay": line,
                "bomb/zeros.brlplay": bytes(1_000_000),
                "cut/a.brlplay": line[:50],
                "empty/a.brlplay": b"",
                "locked/a.zip": bytes(encrypted),
                "none/a.txt": b"",
                "no zip/a.zip": b"PK",
                "torn/a.zip": bytes(broken),
            }
        )
    )
    players = found(path)
    leaves = "its path ada/../../up.brlplay leaves the zip file"
    assert players["ada"] == (["a.brlplay, line 1"], [("../../up.brlplay", leaves)])
    faults = {name: [reason for _, reason in each] for name, (_, each) in players.items()}
    assert faults.pop("/") == ["its path /root.brlplay leaves the zip file"]
    assert faults["bomb"] == ["it is larger than 0 MiB"]
    assert faults["cut"][0].startswith("line 1: the line is cut off")
    assert faults["empty"] == ["the file is empty"]
    assert "encrypted" in faults["locked"][0]
    assert faults["none"] == [f"{NOTHING} a.txt{WANTED}"]
    assert faults["no zip"][0].startswith("the zip file is damaged")
    assert faults["torn"][0].startswith("it cannot be unpacked")


def test_links_out_of_the_folder_are_not_followed(tmp_path: Path, line: bytes) -> None:
    folder = tmp_path / "class"
    (folder / "eve").mkdir(parents=True)
    (folder / "eve" / "a.brlplay").symlink_to(tmp_path / "line.brlplay")
    assert found(folder) == {"eve": ([], [("a.brlplay", "it is a link out of the folder")])}


def test_what_is_read_of_a_player_is_bounded_and_the_others_are_read(
    tmp_path: Path, line: bytes, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "MAX_TOTAL", 2 * len(line))
    monkeypatch.setattr(module, "MAX_FILES", 3)
    monkeypatch.setattr(module, "MAX_NAMES", 5)
    files = {
        "ada/a.brlplay": line,
        **{f"bytes/{number}.brlplay": line for number in range(3)},
        **{f"files/{number}.brlplay": b"" for number in range(4)},
        **{f"names/{number}.txt": b"" for number in range(7)},
        "names/z.brlplay": line,
        "zed/inner.zip": zipped({f"{number}.brlplay": line for number in range(2)}),
        "zoe/a.brlplay": line,
    }
    (tmp_path / "class.zip").write_bytes(zipped(files))
    for name, data in files.items():
        (tmp_path / "class" / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / "class" / name).write_bytes(data)
    for path in (tmp_path / "class", tmp_path / "class.zip"):
        players = found(path)
        told = {name: faults[-1][1] for name, (_, faults) in players.items() if faults}
        assert told == {
            "bytes": "it is not read: the files have more than 0 MiB together",
            "files": "it is not read: these are more than 3 files",
            "names": f"{NOTHING} 0.txt, 1.txt and 2.txt{WANTED}",
            "zed": "it is not read: the files have more than 0 MiB together",
        }
        assert ("", "more than 5 files: the rest is not read") in players["names"][1]
        assert [len(players[name][0]) for name in ("ada", "bytes", "zoe")] == [1, 2, 1]


def test_a_zip_file_with_a_long_list_of_files_is_not_read(
    tmp_path: Path, line: bytes, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = tmp_path / "class"
    folder.mkdir()
    many = {f"{number}.brlplay": b"" for number in range(20)}
    (folder / "ada.zip").write_bytes(zipped({"a.brlplay": line}))
    (folder / "eve.zip").write_bytes(zipped(many))
    with monkeypatch.context() as patched:
        # The list has another form, for more files than these.
        patched.setattr("zipfile.ZIP_FILECOUNT_LIMIT", 10)
        (folder / "mallory.zip").write_bytes(zipped(many))
    assert b"PK\6\6" in (folder / "mallory.zip").read_bytes()
    monkeypatch.setattr("babyrobot_levels.text.files.MAX_DIRECTORY", 1000)
    players = found(folder)
    assert len(players["ada"][0]) == 1
    for name in ("eve", "mallory"):
        assert [told for _, told in players[name][1]] == [
            "the zip file is damaged (it has too many files)"
        ]


def test_the_steps_of_a_player_are_bounded(
    tmp_path: Path, line: bytes, monkeypatch: pytest.MonkeyPatch
) -> None:
    steps = brl.Play.from_line(line).steps
    (tmp_path / "ada.brlplay").write_bytes(5 * line)
    monkeypatch.setattr(module, "MAX_STEPS", 2 * steps)
    places, ((_, reason),) = found(tmp_path / "ada.brlplay")["ada"]
    assert places == ["line 1", "line 2"]
    assert reason == f"more than {2 * steps:,} steps: from line 3 on, it is not graded"
