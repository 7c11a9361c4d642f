"""The storage port, the same tests for every file system."""

from __future__ import annotations

import hashlib
import os
import uuid
from pathlib import Path

import pytest

from core.errors import BadInput
from store.artifacts import ArtifactStore


@pytest.fixture(params=["local", "memory"])
def store(request: pytest.FixtureRequest, tmp_path: Path) -> ArtifactStore:
    root = {"local": tmp_path / "st::ore ?#%", "memory": f"memory://{uuid.uuid4().hex}"}[request.param]
    return ArtifactStore(root)


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
