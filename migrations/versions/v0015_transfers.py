"""Inputs that are fetched by URL are known to every server, with the lease of who fetches them."""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision = "0015"
down_revision = "0014"
branch_labels = None
depends_on = None


def upgrade() -> None:
    """Make the tables; what a server of before was fetching begins anew."""
    op.create_table(
        "transfers",
        sa.Column("id", sa.String(64), nullable=False),
        sa.Column("owner", sa.String(64), nullable=False),
        sa.Column("state", sa.String(16), nullable=False),
        sa.Column("holder", sa.String(128), nullable=True),
        sa.Column("fence", sa.Integer(), nullable=False),
        sa.Column("lease_expires_at", sa.DateTime(), nullable=True),
        sa.Column("created_at", sa.DateTime(), nullable=False),
        sa.Column("asked_at", sa.DateTime(), nullable=False),
        sa.Column("failed", sa.Integer(), nullable=True),
        sa.Column("error", sa.JSON(none_as_null=True), nullable=True),
        sa.PrimaryKeyConstraint("id", name="pk_transfers"),
    )
    op.create_index("ix_transfers_owner", "transfers", ["owner"])
    op.create_table(
        "transfer_files",
        sa.Column("transfer_id", sa.String(64), nullable=False),
        sa.Column("number", sa.Integer(), nullable=False),
        sa.Column("url", sa.String(2000), nullable=False),
        sa.Column("sha256", sa.String(64), nullable=True),
        sa.Column("most_bytes", sa.BigInteger(), nullable=False),
        sa.Column("upload_id", sa.String(64), nullable=True),
        sa.Column("tag", sa.String(256), nullable=False),
        sa.PrimaryKeyConstraint("transfer_id", "number", name="pk_transfer_files"),
        sa.ForeignKeyConstraint(
            ["transfer_id"], ["transfers.id"], name="fk_transfer_files_transfer_id_transfers", ondelete="CASCADE"
        ),
    )


def downgrade() -> None:
    """Drop them: requests fetch anew, and an upload that was not finished ends by its time."""
    op.drop_table("transfer_files")
    op.drop_table("transfers")
