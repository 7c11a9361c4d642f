"""`bladeatlas init`: harmless at any time, and one first key however many run at once."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from pathlib import Path

import pytest

from cli import exits
from cli.main import main
from store.account_models import USUAL_SCOPES
from store.audit import AuditFilter, AuditLog
from store.db import Database
from store.files import ArtifactStore
from store.keys import KeyRing, Keys
from tests.databases import BOTH, database, database_url
from tests.store.object_store import new_bucket, options


@pytest.fixture(params=BOTH)
def address(request: pytest.FixtureRequest, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[str]:
    """A database without tables, as the settings name it."""
    with database_url(request.param, tmp_path) as url:
        text = url.render_as_string(hide_password=False)
        monkeypatch.setenv("BLADEATLAS_DATABASE_URL", text)
        monkeypatch.setenv("BLADEATLAS_DATA_DIR", str(tmp_path / "data"))
        yield text


def test_the_first_key_is_printed_once(address: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["init"]) == exits.DONE
    said = capsys.readouterr()
    key = said.out.strip()
    assert said.out.count("\n") == 1
    assert key not in said.err
    db = Database(address)
    ring = KeyRing(Keys(db))
    ring.refresh()
    found = ring.find(key)
    assert found is not None
    assert (found.account_id, found.scopes) == ("default", USUAL_SCOPES)
    assert (tmp_path / "data" / "artifacts").is_dir()
    assert main(["init"]) == exits.DONE
    again = capsys.readouterr()
    assert again.out == ""
    Keys(db).revoke(found.id)
    assert main(["init"]) == exits.DONE
    assert capsys.readouterr().out == "", "a revoked key is a key that was made"
    entries = AuditLog(db).page(AuditFilter(), 10).entries
    assert [entry.action for entry in entries] == ["bladeatlas init"] * 3
    db.close()


@pytest.mark.parametrize("kind", BOTH)
def test_of_many_at_once_one_makes_the_key(kind: str, tmp_path: Path) -> None:
    with database(kind, tmp_path) as db:
        made: list[object] = []
        barrier = threading.Barrier(8)

        def run() -> None:
            barrier.wait()
            made.append(Keys(db).create_first("first"))

        threads = [threading.Thread(target=run) for _ in range(8)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        assert len(made) == 8
        assert sum(one is not None for one in made) == len(Keys(db).all()) == 1


def test_a_store_that_cannot_be_written_is_told_before_a_key_is_made(
    address: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "file").touch()
    monkeypatch.setenv("BLADEATLAS_ARTIFACTS_URL", f"file://{tmp_path}/file/below")
    assert main(["init"]) == exits.INTERNAL
    said = capsys.readouterr()
    assert "the artifact store cannot be written" in said.err
    assert said.out == ""


def test_a_bucket_is_made_when_it_is_missing(s3: str) -> None:
    made = ArtifactStore("s3://a-new-bucket/and/a/prefix", **options(s3))
    made.prepare()
    made.prepare()
    assert made.list() == []
    ArtifactStore(new_bucket(s3), **options(s3)).prepare()
