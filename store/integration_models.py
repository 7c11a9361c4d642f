"""Tables for the programs around the service.

These are metadata of inspections, events that tell of their changes, webhooks, and inputs that are fetched by URL.
"""

from __future__ import annotations

from datetime import datetime
from enum import StrEnum
from typing import Any

from sqlalchemy import BigInteger, ForeignKey, ForeignKeyConstraint, Index, String, UniqueConstraint
from sqlalchemy.orm import Mapped, mapped_column, relationship

from store.columns import Base, Choice


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


class DeliveryState(StrEnum):
    """How far the delivery of an event to a webhook is."""

    PENDING = "pending"
    """It is sent when its time comes, and those before it of the same inspection are over."""
    DELIVERED = "delivered"
    FAILED = "failed"
    """Given up; it can be sent once more."""


class Webhook(Base):
    """An address that events of an account are sent to; see `store.webhooks`."""

    __tablename__ = "webhooks"

    id: Mapped[str] = mapped_column(String(64), primary_key=True)
    owner: Mapped[str] = mapped_column(String(64), ForeignKey("accounts.id"), index=True)
    url: Mapped[str] = mapped_column(String(2000))
    description: Mapped[str] = mapped_column(String(256))
    types: Mapped[list[str]]
    """Values of `store.events.EventType` that are sent; empty = all."""
    secret: Mapped[str] = mapped_column(String(64))
    """Kept as it is, because every message is signed with it."""
    old_secret: Mapped[str | None] = mapped_column(String(64))
    old_secret_until: Mapped[datetime | None]
    """Messages are signed with the secret of before a rotation too until then."""
    created_at: Mapped[datetime]
    disabled_at: Mapped[datetime | None]
    """When its receiver answered that it is gone (410)."""
    cursor: Mapped[int]
    """Number of the last event of the account for which there are deliveries, where they are wanted."""
    failures: Mapped[int] = mapped_column(default=0)
    """How often in a row nobody answered."""
    paused_until: Mapped[datetime | None]
    """Nothing is sent before, because nobody answered."""
    turn: Mapped[str | None] = mapped_column(String(64))
    """The lease of who sends to it at the moment."""
    turn_at: Mapped[datetime | None]
    """When the last such lease began."""
    turn_ends_at: Mapped[datetime | None]


class WebhookDelivery(Base):
    """An event that is sent to a webhook, and what came of it."""

    __tablename__ = "webhook_deliveries"
    __table_args__ = (
        UniqueConstraint("webhook_id", "number"),
        ForeignKeyConstraint(
            ["owner", "number"], ["inspection_events.owner", "inspection_events.number"], ondelete="CASCADE"
        ),
        Index("ix_webhook_deliveries_webhook_id_state_next_at", "webhook_id", "state", "next_at"),
        Index("ix_webhook_deliveries_webhook_id_inspection_id", "webhook_id", "inspection_id"),
        Index("ix_webhook_deliveries_owner_number", "owner", "number"),
    )

    id: Mapped[str] = mapped_column(String(64), primary_key=True)
    webhook_id: Mapped[str] = mapped_column(String(64), ForeignKey("webhooks.id", ondelete="CASCADE"))
    owner: Mapped[str] = mapped_column(String(64))
    number: Mapped[int | None]
    """Of the event, whose content is in its own row; None for a test."""
    inspection_id: Mapped[str | None] = mapped_column(String(64))
    type: Mapped[str] = mapped_column(String(32))
    state: Mapped[DeliveryState] = mapped_column(Choice(DeliveryState))
    again: Mapped[bool] = mapped_column(default=False)
    """Asked for once more, so it neither waits for others of its inspection nor makes them wait."""
    attempts: Mapped[int] = mapped_column(default=0)
    created_at: Mapped[datetime]
    due_at: Mapped[datetime]
    """When it was to be sent first; so long after that it is given up."""
    next_at: Mapped[datetime | None]
    """When it is sent next; None when it is over."""
    tried_at: Mapped[datetime | None]
    status: Mapped[int | None]
    """Of HTTP, of the last answer; None when there was none."""
    error: Mapped[str] = mapped_column(String(256), default="")
    """Why the last attempt failed."""


class TransferState(StrEnum):
    """How far the files of a request are that are fetched by URL."""

    FETCHING = "fetching"
    """Somebody fetches them, or will when the request is sent again."""
    FETCHED = "fetched"
    REFUSED = "refused"
    """One of them cannot be had; its error is told to who asks next."""


class Transfer(Base):
    """The files of a request that are fetched by URL, with the lease of who fetches them; see `store.transfers`."""

    __tablename__ = "transfers"

    id: Mapped[str] = mapped_column(String(64), primary_key=True)
    """Made from account and files, so that the same request finds it again."""
    owner: Mapped[str] = mapped_column(String(64), index=True)
    state: Mapped[TransferState] = mapped_column(Choice(TransferState))
    files: Mapped[list[TransferFile]] = relationship(
        order_by="TransferFile.number", cascade="all, delete-orphan", passive_deletes=True, lazy="selectin"
    )
    holder: Mapped[str | None] = mapped_column(String(128))
    """The process that fetches."""
    fence: Mapped[int]
    """Grows with every lease; only the holder of the newest may write what came of it."""
    lease_expires_at: Mapped[datetime | None]
    created_at: Mapped[datetime]
    asked_at: Mapped[datetime]
    """When the request was sent last."""
    failed: Mapped[int | None]
    """Number of the file that cannot be had."""
    error: Mapped[dict[str, Any] | None]


class TransferFile(Base):
    """One of these files. Its bytes are those of an upload."""

    __tablename__ = "transfer_files"

    transfer_id: Mapped[str] = mapped_column(
        String(64), ForeignKey("transfers.id", ondelete="CASCADE"), primary_key=True
    )
    number: Mapped[int] = mapped_column(primary_key=True, autoincrement=False)
    url: Mapped[str] = mapped_column(String(2000))
    sha256: Mapped[str | None] = mapped_column(String(64))
    """What it must hash to, where the request says so."""
    most_bytes: Mapped[int] = mapped_column(BigInteger)
    upload_id: Mapped[str | None] = mapped_column(String(64))
    """None until its size is known."""
    tag: Mapped[str] = mapped_column(String(256))
    """The file's ``ETag`` when it is a strong one: with it a transfer goes on where it was. Else empty."""
