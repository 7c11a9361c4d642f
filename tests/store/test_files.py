"""The storage port, the same tests for every file system."""

from __future__ import annotations

import hashlib
import os
import uuid
from pathlib import Path

import pytest

from core.errors import BadInput, ResourceError
from store.files import UNREACHABLE, ArtifactStore, Stored
from tests.store.object_store import new_bucket, options


@pytest.fixture(params=["local", "memory", "s3"])
def store(request: pytest.FixtureRequest, tmp_path: Path) -> ArtifactStore:
    if request.param == "s3":
        address = request.getfixturevalue("s3")
        return ArtifactStore(f"{new_bucket(address)}/some/prefix", **options(address))
    local, memory = tmp_path / "st::ore ?#%", f"memory://{uuid.uuid4().hex}"
    return ArtifactStore(local if request.param == "local" else memory)


@pytest.fixture
def source(tmp_path: Path) -> Path:
    path = tmp_path / "source.bin"
    path.write_bytes(os.urandom(3_000_000))
    return path


def test_what_is_put_is_read_back_with_size_and_hash(store: ArtifactStore, source: Path) -> None:
    stored = store.put("dense/fused.ply", source)
    assert (stored.path, stored.size) == ("dense/fused.ply", 3_000_000)
    assert stored.sha256 == hashlib.sha256(source.read_bytes()).hexdigest()
    with store.open("dense/fused.ply") as stream:
        assert stream.read() == source.read_bytes()
    assert store.exists("dense/fused.ply")
    assert store.size("dense/fused.ply") == 3_000_000


def test_a_file_is_replaced_removed_and_listed(store: ArtifactStore, source: Path, tmp_path: Path) -> None:
    store.put("a/b.txt", source)
    small = tmp_path / "small"
    small.write_text("x")
    store.put("a/b.txt", small)
    store.put("c.txt", small)
    assert store.list() == ["a/b.txt", "c.txt"]
    assert store.size("a/b.txt") == 1
    store.remove("a/b.txt")
    store.remove("a/b.txt")
    assert store.list() == ["c.txt"]
    with pytest.raises(FileNotFoundError), store.open("a/b.txt"):
        pass


def test_files_below_a_folder_are_listed_and_their_age_is_known(store: ArtifactStore, source: Path) -> None:
    for path in ("a/1/x", "a/2/y", "ab/z"):
        store.put(path, source)
    assert store.list("a") == ["a/1/x", "a/2/y"]
    assert store.list("nothing") == []
    assert 0.0 <= store.age_s("ab/z") + 1.0 < 60.0
    with pytest.raises(FileNotFoundError):
        store.age_s("ab/missing")


def test_a_file_is_fetched_whole_or_not_at_all(store: ArtifactStore, source: Path, tmp_path: Path) -> None:
    stored = store.put("a.bin", source)
    target = tmp_path / "cache" / "a.bin"
    with pytest.raises(ResourceError) as caught:
        store.fetch("a.bin", target, "0" * 64)
    assert caught.value.code == "damaged_file"
    assert list(target.parent.iterdir()) == []
    with pytest.raises(FileNotFoundError):
        store.fetch("b.bin", target, stored.sha256)
    assert list(target.parent.iterdir()) == []
    store.fetch("a.bin", target, stored.sha256)
    assert target.read_bytes() == source.read_bytes()


def test_a_linked_file_outlives_its_source(store: ArtifactStore, source: Path) -> None:
    data = source.read_bytes()
    known = Stored("source.bin", len(data), hashlib.sha256(data).hexdigest())
    assert store.link("x/y.bin", source, known) == Stored("x/y.bin", known.size, known.sha256)
    assert store.link("x/y.bin", source, known).sha256 == known.sha256
    store.adopt("x/y.bin", source)
    assert store.sweep() == 0
    if store.folder is not None:
        assert (store.folder / "x/y.bin").stat().st_ino == source.stat().st_ino
    source.unlink()
    with store.open("x/y.bin") as stream:
        assert stream.read() == data


def test_an_object_store_that_does_not_answer_is_said(source: Path) -> None:
    nowhere = options("http://127.0.0.1:9")
    nowhere["config_kwargs"] = {"retries": {"max_attempts": 1}, "connect_timeout": 1}
    store = ArtifactStore("s3://bucket/prefix", **nowhere)
    with pytest.raises(ResourceError) as caught:
        store.put("a.bin", source)
    assert caught.value.code == UNREACHABLE


def test_removing_the_last_file_of_a_folder_removes_the_folder(tmp_path: Path, source: Path) -> None:
    store = ArtifactStore(tmp_path / "store")
    for path in ("a/b/c.bin", "a/d.bin"):
        store.put(path, source)
    store.remove("a/b/c.bin")
    assert [path.name for path in (tmp_path / "store/a").iterdir()] == ["d.bin"]


@pytest.mark.parametrize("path", ["../x", "/etc/passwd", "a/../../x", ""])
def test_no_path_leaves_the_store(store: ArtifactStore, source: Path, path: str) -> None:
    with pytest.raises(BadInput):
        store.put(path, source)


def test_a_write_that_is_cut_off_leaves_the_old_file(tmp_path: Path, source: Path) -> None:
    store = ArtifactStore(tmp_path / "store")
    store.put("a.bin", source)
    folder = tmp_path / "a folder"
    folder.mkdir()
    with pytest.raises(IsADirectoryError):
        store.put("a.bin", folder)
    assert store.size("a.bin") == 3_000_000
    (tmp_path / "store" / ".part-0123").write_text("half")
    assert store.list() == ["a.bin"]
    assert store.sweep() == 1
    assert sorted(p.name for p in (tmp_path / "store").iterdir()) == ["a.bin"]
