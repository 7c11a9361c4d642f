"""Inspections have metadata, and tell of their changes by numbered events."""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision = "0010"
down_revision = "0009"
branch_labels = None
depends_on = None


def upgrade() -> None:
    """Make the tables; what there was has no metadata and no events."""
    op.create_table(
        "inspection_metadata",
        sa.Column("inspection_id", sa.String(64), nullable=False),
        sa.Column("name", sa.String(64), nullable=False),
        sa.Column("value", sa.String(256), nullable=False),
        sa.PrimaryKeyConstraint("inspection_id", "name", name="pk_inspection_metadata"),
        sa.ForeignKeyConstraint(
            ["inspection_id"],
            ["inspections.id"],
            name="fk_inspection_metadata_inspection_id_inspections",
            ondelete="CASCADE",
        ),
    )
    op.create_index("ix_inspection_metadata_name_value", "inspection_metadata", ["name", "value"])
    op.create_table(
        "event_counters",
        sa.Column("owner", sa.String(64), nullable=False),
        sa.Column("last", sa.Integer(), nullable=False),
        sa.PrimaryKeyConstraint("owner", name="pk_event_counters"),
    )
    op.create_table(
        "inspection_events",
        sa.Column("owner", sa.String(64), nullable=False),
        sa.Column("number", sa.Integer(), nullable=False),
        sa.Column("inspection_id", sa.String(64), nullable=False),
        sa.Column("type", sa.String(32), nullable=False),
        sa.Column("at", sa.DateTime(), nullable=False),
        sa.Column("data", sa.JSON(), nullable=False),
        sa.PrimaryKeyConstraint("owner", "number", name="pk_inspection_events"),
        sa.ForeignKeyConstraint(
            ["inspection_id"],
            ["inspections.id"],
            name="fk_inspection_events_inspection_id_inspections",
            ondelete="CASCADE",
        ),
    )
    op.create_index("ix_inspection_events_at", "inspection_events", ["at"])
    op.create_index("ix_inspection_events_inspection_id_number", "inspection_events", ["inspection_id", "number"])
    with op.batch_alter_table("inspections") as table:
        table.add_column(sa.Column("told", sa.String(96), nullable=False, server_default=""))


def downgrade() -> None:
    """Drop them."""
    with op.batch_alter_table("inspections") as table:
        table.drop_column("told")
    for name in ("inspection_events", "event_counters", "inspection_metadata"):
        op.drop_table(name)
