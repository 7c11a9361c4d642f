"""Result folders: whole or not at all, and named by what is in them."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from core.fingerprint import digest_of
from worker.results import MANIFEST, Manifest, ResultFolders, seal

NAME = digest_of("a task")


@pytest.fixture
def folders(tmp_path: Path) -> ResultFolders:
    return ResultFolders(tmp_path / "results")


def write(folder: Path, text: str = "points", facts: dict[str, object] | None = None, seconds: float = 1.0) -> Manifest:
    (folder / "model").mkdir()
    (folder / "model" / "points.bin").write_text(text)
    return seal(folder, fingerprint=NAME, key="join", version=2, facts=facts or {"n": 1}, seconds=seconds, rss=5)


def test_a_sealed_and_committed_folder_is_a_result(folders: ResultFolders) -> None:
    temporary = folders.begin("join", NAME)
    sealed = write(temporary)
    assert folders.find("join", NAME) is None
    assert folders.commit(temporary, "join", NAME) == sealed == folders.find("join", NAME)
    assert list(sealed.files) == ["model/points.bin"]
    assert list(folders.all()) == [sealed]
    assert not temporary.exists()


def test_the_digest_follows_facts_and_files_but_not_time(folders: ResultFolders) -> None:
    digests = [
        write(folders.begin("join", NAME)).digest,
        write(folders.begin("join", NAME), seconds=9.0).digest,
        write(folders.begin("join", NAME), text="other").digest,
        write(folders.begin("join", NAME), facts={"n": 2}).digest,
    ]
    assert digests[0] == digests[1]
    assert len(set(digests)) == 3


def test_the_first_of_two_equal_results_stays(folders: ResultFolders) -> None:
    first, second = folders.begin("join", NAME), folders.begin("join", NAME)
    write(first, seconds=1.0)
    write(second, seconds=2.0)
    folders.commit(first, "join", NAME)
    assert folders.commit(second, "join", NAME).seconds == 1.0
    assert not second.exists()


@pytest.mark.parametrize("damage", ["missing", "short", "no manifest", "half a manifest", "moved"])
def test_a_damaged_result_is_none_and_is_replaced(folders: ResultFolders, damage: str) -> None:
    temporary = folders.begin("join", NAME)
    write(temporary)
    folders.commit(temporary, "join", NAME)
    folder = folders.path(folders.relative("join", NAME))
    if damage == "missing":
        (folder / "model" / "points.bin").unlink()
    elif damage == "short":
        (folder / "model" / "points.bin").write_text("point")
    elif damage == "no manifest":
        (folder / MANIFEST).unlink()
    elif damage == "half a manifest":
        (folder / MANIFEST).write_text((folder / MANIFEST).read_text()[:100])
    else:
        manifest = json.loads((folder / MANIFEST).read_text())
        (folder / MANIFEST).write_text(json.dumps({**manifest, "fingerprint": digest_of("another")}))
    assert folders.find("join", NAME) is None
    assert list(folders.all()) == []
    again = folders.begin("join", NAME)
    sealed = write(again)
    assert folders.commit(again, "join", NAME) == sealed


def test_sweeping_leaves_results_and_removes_attempts(folders: ResultFolders) -> None:
    temporary = folders.begin("join", NAME)
    write(temporary)
    folders.commit(temporary, "join", NAME)
    write(folders.begin("join", digest_of("cut off")))
    assert folders.sweep() == 1
    assert [manifest.fingerprint for manifest in folders.all()] == [NAME]
    folders.remove("join", NAME)
    assert list(folders.all()) == []
    assert folders.sweep() == 0


def test_facts_must_be_finite(folders: ResultFolders) -> None:
    with pytest.raises(ValueError, match="JSON"):
        write(folders.begin("join", NAME), facts={"error_px": float("nan")})
