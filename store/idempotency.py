"""Requests that have one effect however often they are sent.

The key is written in the transaction that creates the inspection, so a crash leaves either both or neither,
and of two equal requests at once the database lets one through; the other finds what it made.
"""

from __future__ import annotations

from dataclasses import dataclass

from sqlalchemy.orm import Session

from core.errors import BadInput
from store.db import Database
from store.models import IdempotencyKey


class OtherBody(BadInput):
    """The key was used with another body."""

    code = "idempotency_key_reused"


@dataclass(frozen=True)
class IdempotencyKeys:
    """Keys of all owners."""

    db: Database

    def find(self, owner: str, key: str, body_sha256: str) -> str | None:
        """Inspection that this request made before; None when it is new.

        Raises:
            OtherBody: the key belongs to a request with another body.
        """
        with self.db.read() as session:
            row = session.get(IdempotencyKey, (owner, key))
        if row is None:
            return None
        if row.body_sha256 != body_sha256:
            raise OtherBody("this Idempotency-Key was used with another body", where="Idempotency-Key")
        return row.inspection_id

    def add(self, session: Session, owner: str, key: str, body_sha256: str, inspection_id: str) -> None:
        """Write the key inside the transaction that creates the inspection; IntegrityError when it is there."""
        row = IdempotencyKey(owner=owner, key=key, body_sha256=body_sha256, inspection_id=inspection_id)
        row.created_at = self.db.now(session)
        session.add(row)
        session.flush()
