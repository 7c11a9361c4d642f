"""What callers name an inspection by: label, external id, metadata. It may change at any time and changes no result."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from core.metadata import require_few
from store.db import Database
from store.events import EventType, tell
from store.leasing import lock_inspection, metadata_of, set_metadata


@dataclass(frozen=True)
class Naming:
    """What is to be changed; None leaves a value as it is."""

    label: str | None = None
    external_id: str | None = None
    priority: int | None = None
    metadata: Mapping[str, str | None] | None = None
    """Entries to be set; those that are None or empty are removed, others stay."""


def rename(db: Database, inspection_id: str, naming: Naming) -> None:
    """Change what an inspection is named by, in one transaction.

    Args:
        db: where it is.
        inspection_id: of the inspection.
        naming: the changes.

    Raises:
        BadInput: there is no such inspection, or it would have too many entries.
    """
    with db.write() as session:
        row, now = lock_inspection(session, inspection_id), db.now(session)
        for name in ("label", "external_id", "priority"):
            value = getattr(naming, name)
            if value is not None:
                setattr(row, name, value)
        if naming.metadata is not None:
            merged = {**metadata_of(row), **{name: text or "" for name, text in naming.metadata.items()}}
            merged = {name: text for name, text in merged.items() if text}
            require_few(merged, "metadata")
            set_metadata(row, merged)
        row.updated_at = now
        tell(session, row, EventType.RENAMED, now)
