"""Resumable uploads: rows that say what is surely on disk, and the bytes beside them under the row's id."""

from __future__ import annotations

import uuid
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from datetime import timedelta
from pathlib import Path
from typing import Any

from sqlalchemy import update
from sqlalchemy.orm import Session

from store.db import Database
from store.disk import sync_path
from store.leasing import changed
from store.models import Upload

_PART = "form-"
"""Begin of the names of files that came in a form: they have no row and live as long as their request."""


@dataclass(frozen=True)
class UploadView:
    """An upload as others may see it."""

    id: str
    owner: str
    length: int
    offset: int
    """Bytes that are surely on disk: at most what was committed, and at most what the file holds."""
    metadata: Mapping[str, Any]
    sha256: str | None
    """Of the whole file; None until it is whole and was read once."""
    removed: bool

    @property
    def complete(self) -> bool:
        """True once every byte is there."""
        return self.offset == self.length


@dataclass(frozen=True)
class Uploads:
    """All uploads of one folder."""

    db: Database
    folder: Path
    keep_hours: float = 72.0

    def path(self, upload_id: str) -> Path:
        """Where the bytes of an upload lie."""
        return self.folder / upload_id

    def part(self) -> Path:
        """A new name for a file that comes in a form."""
        self.folder.mkdir(parents=True, exist_ok=True)
        return self.folder / f"{_PART}{uuid.uuid4().hex}"

    def create(
        self, owner: str, length: int, metadata: Mapping[str, str], admit: Callable[[Session], None] | None = None
    ) -> UploadView:
        """A new upload of `length` bytes. The file is there before the row, so that a row never lacks its file.

        `admit` is called in the transaction that makes the row; what it raises leaves nothing behind.
        """
        upload_id = uuid.uuid4().hex
        self.folder.mkdir(parents=True, exist_ok=True)
        self.path(upload_id).touch(mode=0o600, exist_ok=False)
        try:
            sync_path(self.folder)
            return self._insert(upload_id, owner, length, metadata, admit)
        except BaseException:
            self.path(upload_id).unlink(missing_ok=True)
            raise

    def _insert(
        self,
        upload_id: str,
        owner: str,
        length: int,
        metadata: Mapping[str, str],
        admit: Callable[[Session], None] | None,
    ) -> UploadView:
        with self.db.write() as session:
            if admit is not None:
                admit(session)
            now = self.db.now(session)
            row = Upload(
                id=upload_id,
                owner=owner,
                length=length,
                offset=0,
                upload_metadata=dict(metadata),
                created_at=now,
                updated_at=now,
                expires_at=now + timedelta(hours=self.keep_hours),
            )
            session.add(row)
        return _view(row)

    def find(self, upload_id: str, owner: str) -> UploadView | None:
        """An upload of this owner; None when there is none. A removed one is found, with its mark."""
        with self.db.read() as session:
            row = session.get(Upload, upload_id)
        if row is None or row.owner != owner:
            return None
        view = _view(row)
        try:
            size = self.path(upload_id).stat().st_size
        except FileNotFoundError:
            return replace(view, offset=0, removed=True)
        return replace(view, offset=min(view.offset, size))

    def commit(self, upload_id: str, offset: int, sha256: str | None = None) -> bool:
        """Note that `offset` bytes are on disk for certain; False when the upload was removed meanwhile."""
        values: dict[str, Any] = {"offset": offset}
        if sha256 is not None:
            values["sha256"] = sha256
        with self.db.write() as session:
            where = (Upload.id == upload_id, Upload.removed_at.is_(None))
            return changed(session, update(Upload).where(*where).values(updated_at=self.db.now(session), **values))

    def remove(self, upload_id: str) -> None:
        """End an upload; its row stays, so that its id answers 410."""
        with self.db.write() as session:
            where = (Upload.id == upload_id, Upload.removed_at.is_(None))
            changed(session, update(Upload).where(*where).values(removed_at=self.db.now(session)))
        self.path(upload_id).unlink(missing_ok=True)


def _view(row: Upload) -> UploadView:
    return UploadView(
        id=row.id,
        owner=row.owner,
        length=row.length,
        offset=row.offset,
        metadata=dict(row.upload_metadata),
        sha256=row.sha256,
        removed=row.removed_at is not None,
    )
