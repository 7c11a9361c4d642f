"""Detections say where on their blade they lie, and events on which blade."""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision = "0014"
down_revision = "0013"
branch_labels = None
depends_on = None

_NUMBERS = ("span", "chord", "edge_distance", "root_distance")


def upgrade() -> None:
    """Add the columns; rows of before know no row."""
    with op.batch_alter_table("detections") as table:
        table.add_column(sa.Column("side", sa.String(), nullable=True))
        for name in _NUMBERS:
            table.add_column(sa.Column(name, sa.Double(), nullable=True))
            table.add_column(sa.Column(f"{name}_sigma", sa.Double(), nullable=True))
    with op.batch_alter_table("events") as table:
        table.add_column(sa.Column("blade", sa.String(), nullable=True))


def downgrade() -> None:
    """Drop them."""
    with op.batch_alter_table("events") as table:
        table.drop_column("blade")
    with op.batch_alter_table("detections") as table:
        table.drop_column("side")
        for name in _NUMBERS:
            table.drop_column(name)
            table.drop_column(f"{name}_sigma")
