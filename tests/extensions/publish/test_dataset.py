"""Levels as rows: what other libraries read, the split of each level, and what is refused."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import pytest
from support.sessions import babyrobot

import babyrobot_levels as brl

SUITE: dict[str, Any] = {
    "version": 1,
    "kind": "suite",
    "name": "few",
    "title": "A few",
    "license": "MIT",
    "count": 6,
    "size": [4, 4],
    "keys": "0..1",
    "splits": {"train": 0.5, "test": 0.5},
}


@pytest.fixture(autouse=True)
def _offline(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("HF_HUB_OFFLINE", "1")
    monkeypatch.setenv("HF_HOME", str(tmp_path / "hub"))
    monkeypatch.chdir(tmp_path)


def loaded(folder: str) -> Any:
    from datasets import load_dataset

    return load_dataset(folder, cache_dir=str(Path("cache")))


def test_datasets_reads_the_levels_of_each_split_with_their_metrics_and_pictures() -> None:
    suite = brl.load_suite(SUITE)
    made = brl.dataset(suite, "few", jobs=2)
    assert made.splits == {"train": 3, "test": 3}
    rows = loaded("few")
    assert {name: split.num_rows for name, split in rows.items()} == made.splits
    for name, split in rows.items():
        for row, level in zip(split, suite.split(name), strict=True):
            again = brl.loads(row["level"])
            assert again == brl.loads(level.to_yaml())
            assert row["digest"] == level.digest == brl.load(row["code"]).digest
            metrics = brl.metrics(level).to_dict()
            for metric, value in metrics.items():
                assert row[metric] == (list(value) if isinstance(value, tuple) else value)
            assert (row["needs"] is None) == (not level.has_things)
            assert row["picture"].size[0] <= 400


def test_the_hub_knows_splits_title_and_license_from_the_card() -> None:
    from huggingface_hub import DatasetCard

    brl.dataset(SUITE, "few", license="cc-by-4.0")
    card = DatasetCard.load("few/README.md")
    assert (card.data.pretty_name, card.data.license) == ("A few", "cc-by-4.0")
    files = card.data.to_dict()["configs"][0]["data_files"]
    assert [each["split"] for each in files] == ["train", "test"]
    assert all(Path("few", each["path"]).is_file() for each in files)
    assert "The number of cells that are not blocked." in card.text
    assert "size: [4, 4]" in card.text


# mlcroissant uses what RDFLib would have it replace.
@pytest.mark.filterwarnings("ignore::DeprecationWarning:rdflib")
@pytest.mark.filterwarnings("ignore::DeprecationWarning:mlcroissant")
def test_croissant_describes_what_is_there(caplog: pytest.LogCaptureFixture) -> None:
    import mlcroissant

    brl.dataset(SUITE, "few", license="cc-by-4.0")
    read = mlcroissant.Dataset(jsonld="few/croissant.json")
    assert "not standard" not in caplog.text
    assert not read.metadata.ctx.issues.errors
    assert read.metadata.ctx.is_v1_1()
    first = next(iter(read.records("test")))
    assert brl.loads(first["test/level"].decode()).digest == first["test/digest"].decode()
    assert first["test/picture"].size[0] <= 400


def test_levels_of_no_suite_are_all_in_train() -> None:
    brl.dataset(["first-key", "random-maze", "four-rooms"], "mixed", title="Mixed")
    rows = loaded("mixed")["train"]
    assert rows["name"][:] == ["first-key", "random-maze", "four-rooms"]
    assert rows[0]["needs"] == ["key"]
    # A maze that differs from reset to reset is that of seed 0.
    assert brl.loads(rows[1]["level"]).digest == brl.load("random-maze").with_maze_seed(0).digest


def test_a_split_and_the_first_levels_of_a_suite_can_be_chosen() -> None:
    suite = brl.load_suite(SUITE)
    assert brl.dataset(suite.split("test"), "one").splits == {"test": 3}
    assert brl.dataset(suite[:2], "two").splits == {"train": 2}


def test_what_is_there_is_replaced_only_if_it_is_a_data_set_and_only_by_force() -> None:
    done = babyrobot("dataset", "first-key", "-o", "set")
    assert (done.status, done.out) == (0, "wrote a data set to set: 1 in train\n")
    done = babyrobot("dataset", "maze", "-o", "set")
    assert done.status == 2
    assert done.err == "error: there is a data set in set\n  help: use --force to replace it\n"
    assert babyrobot("dataset", "four-rooms", "-o", "set", "--force").status == 0
    assert loaded("set")["train"]["name"][:] == ["four-rooms"]
    Path("set/notes.txt").write_text("mine")
    done = babyrobot("dataset", "four-rooms", "-o", "set", "--force")
    assert done.status == 2
    assert "is there, and is no data set" in done.err
    assert Path("set/notes.txt").read_text() == "mine"


def test_a_level_with_an_error_leaves_no_folder() -> None:
    Path("broken.yaml").write_text("version: 1\nsize: [2, 2]\nexit: [5, 5]\n")
    done = babyrobot("dataset", "broken.yaml", "-o", "set")
    assert done.status == 1
    assert "broken.yaml:3:" in done.err
    assert not Path("set").exists()


def test_without_pyarrow_what_to_install_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    with pytest.raises(ImportError, match="a data set needs PyArrow: install the extra `parquet`"):
        brl.dataset("first-key", "set")
