"""Tables for the programs around the service: metadata of inspections, and the events that tell of their changes."""

from __future__ import annotations

from datetime import datetime
from typing import Any

from sqlalchemy import ForeignKey, Index, String
from sqlalchemy.orm import Mapped, mapped_column

from store.columns import Base


class MetadataEntry(Base):
    """One entry of the metadata of an inspection; see `core.metadata`."""

    __tablename__ = "inspection_metadata"
    __table_args__ = (Index("ix_inspection_metadata_name_value", "name", "value"),)

    inspection_id: Mapped[str] = mapped_column(
        String(64), ForeignKey("inspections.id", ondelete="CASCADE"), primary_key=True
    )
    name: Mapped[str] = mapped_column(String(64), primary_key=True)
    value: Mapped[str] = mapped_column(String(256))


class EventCounter(Base):
    """Number of the last event of an account.

    Whoever writes an event holds this row to the end of the transaction, so that numbers are seen in their order: who
    has read an event never finds a smaller number later.
    """

    __tablename__ = "event_counters"

    owner: Mapped[str] = mapped_column(String(64), primary_key=True)
    last: Mapped[int]


class InspectionEvent(Base):
    """A change of an inspection, numbered within its account from 1; see `store.events`."""

    __tablename__ = "inspection_events"
    __table_args__ = (Index("ix_inspection_events_inspection_id_number", "inspection_id", "number"),)

    owner: Mapped[str] = mapped_column(String(64), primary_key=True)
    number: Mapped[int] = mapped_column(primary_key=True, autoincrement=False)
    inspection_id: Mapped[str] = mapped_column(String(64), ForeignKey("inspections.id", ondelete="CASCADE"))
    type: Mapped[str] = mapped_column(String(32))
    """A value of `store.events.EventType`."""
    at: Mapped[datetime] = mapped_column(index=True)
    data: Mapped[dict[str, Any]]
    """What is told of the inspection as it was then."""
