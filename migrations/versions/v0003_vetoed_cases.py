"""Cases say whether a check vetoed their model."""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision = "0003"
down_revision = "0002"
branch_labels = None
depends_on = None


def upgrade() -> None:
    """Add the column; cases from before were never judged."""
    with op.batch_alter_table("cases") as table:
        table.add_column(sa.Column("vetoed", sa.Integer(), nullable=False, server_default="0"))


def downgrade() -> None:
    """Drop it."""
    with op.batch_alter_table("cases") as table:
        table.drop_column("vetoed")
