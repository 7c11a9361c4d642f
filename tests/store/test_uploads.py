"""Rows and bytes of uploads, on SQLite and PostgreSQL."""

from __future__ import annotations

import hashlib
from pathlib import Path

import pytest

from store.db import Database
from store.uploads import Digests, UploadFile, UploadLocked, Uploads


@pytest.fixture
def uploads(db: Database, tmp_path: Path) -> Uploads:
    return Uploads(db, tmp_path / "uploads")


def test_an_upload_is_its_owners_alone(uploads: Uploads) -> None:
    made = uploads.create("me", 10, {"filename": "ü.mp4", "nul": "\0"})
    found = uploads.find(made.id, "me")
    assert found == made
    assert found is not None
    assert (found.offset, found.complete, found.metadata) == (0, False, {"filename": "ü.mp4", "nul": "\0"})
    assert uploads.find(made.id, "you") is None
    assert uploads.find("0" * 32, "me") is None


def test_only_what_is_committed_and_there_counts(uploads: Uploads) -> None:
    made = uploads.create("", 10, {})
    uploads.path(made.id).write_bytes(b"0123456789")
    assert uploads.find(made.id, "").offset == 0  # type: ignore[union-attr]
    assert uploads.commit(made.id, 8)
    assert uploads.find(made.id, "").offset == 8  # type: ignore[union-attr]
    uploads.path(made.id).write_bytes(b"01234")
    assert uploads.find(made.id, "").offset == 5  # type: ignore[union-attr]


def test_a_large_upload_fits(uploads: Uploads) -> None:
    made = uploads.create("", 1 << 40, {})
    assert uploads.find(made.id, "").length == 1 << 40  # type: ignore[union-attr]


def test_what_is_removed_takes_no_more_bytes(uploads: Uploads) -> None:
    made = uploads.create("", 10, {})
    uploads.remove(made.id)
    assert uploads.find(made.id, "").removed  # type: ignore[union-attr]
    assert not uploads.path(made.id).exists()
    assert not uploads.commit(made.id, 5)


def test_a_lost_file_counts_as_removed(uploads: Uploads) -> None:
    made = uploads.create("", 10, {})
    uploads.path(made.id).unlink()
    assert uploads.find(made.id, "").removed  # type: ignore[union-attr]


def test_a_file_has_one_writer_and_its_hash_follows(uploads: Uploads) -> None:
    made, digests = uploads.create("", 6, {}), Digests()
    path = uploads.path(made.id)
    with UploadFile(path, digests) as file:
        file.resume(0)
        file.write(b"abc")
        with pytest.raises(UploadLocked):
            UploadFile(path, Digests())
    with UploadFile(path, digests) as file:
        file.resume(3)
        file.write(b"def")
        file.sync()
        assert file.sha256() == hashlib.sha256(b"abcdef").hexdigest()
    with UploadFile(path, Digests()) as file:
        file.resume(3)
        file.write(b"xyz")
        assert file.sha256() is None, "what was not followed from the first byte is not claimed"
    assert path.read_bytes() == b"abcxyz"


def test_a_hash_of_other_bytes_is_not_taken_up(uploads: Uploads) -> None:
    made, digests = uploads.create("", 6, {}), Digests()
    with UploadFile(uploads.path(made.id), digests) as file:
        file.resume(0)
        file.write(b"abcdef")
    with UploadFile(uploads.path(made.id), digests) as file:
        file.resume(3)
        file.write(b"xyz")
        assert file.sha256() is None


def test_few_hashes_are_remembered() -> None:
    digests = Digests()
    for number in range(1000):
        digests.keep(str(number), 1, hashlib.sha256())
    assert digests.take("0", 1) is None
    assert digests.take("999", 1) is not None
    assert digests.take("999", 1) is None, "it is given out once"
