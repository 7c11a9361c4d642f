"""An account has a secret that its signed links are made with."""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision = "0012"
down_revision = "0011"
branch_labels = None
depends_on = None


def upgrade() -> None:
    """Add the column; an account gets its secret with its first link."""
    with op.batch_alter_table("accounts") as table:
        table.add_column(sa.Column("link_secret", sa.String(64), nullable=True))


def downgrade() -> None:
    """Drop it; links that were given out end."""
    with op.batch_alter_table("accounts") as table:
        table.drop_column("link_secret")
