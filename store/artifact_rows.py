"""What the table of artifacts says: which files of an inspection can be fetched."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime

from sqlalchemy import select

from store.db import Database
from store.models import Artifact


@dataclass(frozen=True)
class ArtifactView:
    """One published file."""

    path: str
    key: str
    """Where it lies in the artifact store."""
    size: int
    sha256: str
    media_type: str
    created_at: datetime


@dataclass(frozen=True)
class ArtifactRows:
    """Published files of all inspections."""

    db: Database

    def all(self, inspection_id: str) -> Sequence[ArtifactView]:
        """Every published file of an inspection, by path."""
        query = select(Artifact).where(Artifact.inspection_id == inspection_id).order_by(Artifact.path)
        with self.db.read() as session:
            return [_view(row) for row in session.scalars(query)]

    def find(self, inspection_id: str, path: str) -> ArtifactView | None:
        """One published file; None when this inspection has none of that name."""
        with self.db.read() as session:
            row = session.get(Artifact, (inspection_id, path))
        return _view(row) if row is not None else None


def _view(row: Artifact) -> ArtifactView:
    return ArtifactView(row.path, row.key, row.size, row.sha256, row.media_type, row.created_at)
