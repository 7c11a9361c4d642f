"""All that an account has: told for an export, and deleted.

Files go with the next rounds of the cleaners, as those of any deleted inspection; the audit log stays until its time.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from datetime import datetime
from typing import Any

from sqlalchemy import delete, select, update

from store.account_models import DEFAULT_ACCOUNT, Account, ApiKey
from store.accounts import Accounts
from store.audit import AuditFilter, AuditLog
from store.db import Database
from store.inspections import mark_deleted
from store.integration_models import InspectionEvent, MetadataEntry, Transfer
from store.keys import Keys
from store.leasing import input_files, metadata_of
from store.models import ACTIVE_INSPECTION, Artifact, IdempotencyKey, Inspection, Upload
from store.plan import Plan
from store.review_models import ReviewEntry
from store.reviews import Reviews
from store.webhooks import Webhooks, delete_webhooks

_PAGE = 500


@dataclass(frozen=True)
class AccountFile:
    """A file that belongs to an inspection of an account."""

    inspection_id: str
    path: str
    """Within the inspection: of the contract of outputs, or ``inputs/video`` and ``inputs/annotations``.

    Those of further videos are ``inputs/1/video`` and so on, by their number.
    """
    key: str
    """Where it lies in the artifact store."""


@dataclass(frozen=True)
class AccountData:
    """What one account has."""

    db: Database
    account_id: str

    def record(self) -> dict[str, Any]:
        """Account, keys and webhooks (without what opens anything), inspections, uploads, its part of the audit log.

        Raises:
            BadInput: there is no such account.
        """
        account = Accounts(self.db).get(self.account_id)
        with self.db.read() as session:
            uploads = session.scalars(select(Upload).where(Upload.owner == self.account_id).order_by(Upload.created_at))
            return {
                "account": plain(asdict(account)),
                "keys": [plain(asdict(key)) for key in Keys(self.db).all(self.account_id)],
                "inspections": [
                    _inspection(row) | {"reviews": [one.to_dict() for one in Reviews(self.db).since(row.id)]}
                    for row in self._inspections()
                ],
                "webhooks": [plain(asdict(one)) for one in Webhooks(self.db).all(self.account_id)],
                "uploads": [_upload(row) for row in uploads],
                "audit": [plain(asdict(entry)) for entry in self._audit()],
            }

    def files(self) -> Iterator[AccountFile]:
        """Every file of every inspection that was not deleted."""
        for row in self._inspections():
            yield from _inputs(row)
            with self.db.read() as session:
                published = select(Artifact.path, Artifact.key).where(Artifact.inspection_id == row.id)
                found = session.execute(published.order_by(Artifact.path)).all()
            yield from (AccountFile(row.id, path, key) for path, key in found)

    def delete(self, plan: Plan) -> list[str]:
        """Delete everything, revoke all keys and close the account; returns the ids of its inspections.

        The account `default` stays open, because what is made without a key needs it. Harmless when it is repeated,
        after it was cut off or for what a request that was under way has left.

        Raises:
            BadInput: there is no such account.
        """
        Accounts(self.db).get(self.account_id)
        with self.db.write() as session:
            now = self.db.now(session)
            keys = update(ApiKey).where(ApiKey.account_id == self.account_id, ApiKey.revoked_at.is_(None))
            session.execute(keys.values(revoked_at=now))
            uploads = update(Upload).where(Upload.owner == self.account_id, Upload.removed_at.is_(None))
            session.execute(uploads.values(removed_at=now, upload_metadata={}))
            session.execute(delete(Transfer).where(Transfer.owner == self.account_id))  # its lease ends with it
            session.execute(delete(IdempotencyKey).where(IdempotencyKey.owner == self.account_id))
        had: list[str] = []
        while rows := self._inspections():
            for row in rows:
                if row.state in ACTIVE_INSPECTION:
                    plan.cancel(row.id)
                mark_deleted(self.db, row.id)
            had += [row.id for row in rows]
        with self.db.write() as session:
            owned = select(Inspection.id).where(Inspection.owner == self.account_id)
            session.execute(delete(MetadataEntry).where(MetadataEntry.inspection_id.in_(owned)))
            delete_webhooks(session, self.account_id)
            session.execute(delete(InspectionEvent).where(InspectionEvent.owner == self.account_id))
            session.execute(delete(ReviewEntry).where(ReviewEntry.inspection_id.in_(owned)))
            said = update(Inspection).where(Inspection.owner == self.account_id)
            session.execute(said.values(label="", external_id="", parameters=None))
            if self.account_id != DEFAULT_ACCOUNT:
                account = session.get_one(Account, self.account_id)
                account.link_secret = None
                account.closed_at, account.name = account.closed_at or self.db.now(session), account.id
        return had

    def _inspections(self) -> Sequence[Inspection]:
        query = select(Inspection).where(Inspection.owner == self.account_id, Inspection.deleted_at.is_(None))
        with self.db.read() as session:
            return session.scalars(query.order_by(Inspection.created_at, Inspection.id)).all()

    def _audit(self) -> Iterator[Any]:
        cursor: str | None = None
        while True:
            page = AuditLog(self.db).page(AuditFilter(self.account_id), _PAGE, cursor)
            yield from page.entries
            if (cursor := page.cursor) is None:
                return


def _inspection(row: Inspection) -> dict[str, Any]:
    names = ("id", "state", "label", "external_id", "priority", "parameters", "settings", "error", "attempt")
    times = ("created_at", "started_at", "ended_at", "expires_at")
    hashes = ("video_sha256", "annotations_sha256")
    further = [
        {"video_sha256": one.video_sha256, "annotations_sha256": one.annotations_sha256} for one in input_files(row)[1:]
    ]
    told = plain({name: getattr(row, name) for name in (*names, *times, *hashes)})
    return told | {"further_videos": further, "metadata": metadata_of(row)}


def _inputs(row: Inspection) -> Iterator[AccountFile]:
    for number, one in enumerate(input_files(row)):
        folder = f"inputs/{number}" if number else "inputs"
        yield AccountFile(row.id, f"{folder}/video", one.video)
        if one.annotations is not None:
            yield AccountFile(row.id, f"{folder}/annotations", one.annotations)


def _upload(row: Upload) -> dict[str, Any]:
    names = ("id", "length", "offset", "upload_metadata", "sha256", "created_at", "expires_at", "removed_at")
    return plain({name: getattr(row, name) for name in names})


def plain(values: Mapping[str, Any]) -> dict[str, Any]:
    """With moments as texts, for JSON."""
    return {name: value.isoformat() if isinstance(value, datetime) else value for name, value in values.items()}
