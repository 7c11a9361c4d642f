"""The table of what people say of the findings of inspections."""

from __future__ import annotations

from datetime import datetime
from typing import Any

from sqlalchemy import ForeignKey, String, UniqueConstraint
from sqlalchemy.orm import Mapped, mapped_column

from store.columns import Base


class ReviewEntry(Base):
    """One review record of an inspection: written once, never changed; see `core.review.record`."""

    __tablename__ = "reviews"
    __table_args__ = (UniqueConstraint("inspection_id", "record_id"),)

    inspection_id: Mapped[str] = mapped_column(
        String(64), ForeignKey("inspections.id", ondelete="CASCADE"), primary_key=True
    )
    revision: Mapped[int] = mapped_column(primary_key=True, autoincrement=False)
    """From 1 without gaps: given under the lock of the inspection, whoever writes."""
    record_id: Mapped[str] = mapped_column(String(64))
    """Made by whoever wrote it, so that what is sent twice is kept once."""
    at: Mapped[datetime]
    key_id: Mapped[str] = mapped_column(String(64))
    """Of the key that it was written with; empty without one."""
    record: Mapped[dict[str, Any]]
    """All of it, with who and when as it is shown."""
