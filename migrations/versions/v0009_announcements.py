"""A task notes when workers were told of it, and a worker how many tasks it takes by message."""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision = "0009"
down_revision = "0008"
branch_labels = None
depends_on = None


def upgrade() -> None:
    """Add the columns: nobody was told of anything yet, and a worker says how many it takes when it reports itself."""
    # Without batches: SQLite would make the table anew, and forget that ids of deleted tasks never come back.
    op.add_column("tasks", sa.Column("announced_at", sa.DateTime(), nullable=True))
    op.add_column("workers", sa.Column("slots", sa.Integer(), nullable=False, server_default="0"))


def downgrade() -> None:
    """Drop them."""
    op.drop_column("workers", "slots")
    op.drop_column("tasks", "announced_at")
