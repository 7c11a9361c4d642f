"""An inspection may have several videos, and the rows of its tables say which they are of."""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision = "0007"
down_revision = "0006"
branch_labels = None
depends_on = None

_TABLES = ("detections", "events")


def upgrade() -> None:
    """Make the table, and add the columns; what there was is of the first video."""
    op.create_table(
        "further_videos",
        sa.Column("inspection_id", sa.String(64), nullable=False),
        sa.Column("number", sa.Integer(), nullable=False),
        sa.Column("video_path", sa.String(), nullable=False),
        sa.Column("video_sha256", sa.String(64), nullable=False),
        sa.Column("annotations_path", sa.String(), nullable=True),
        sa.Column("annotations_sha256", sa.String(64), nullable=True),
        sa.PrimaryKeyConstraint("inspection_id", "number", name="pk_further_videos"),
        sa.ForeignKeyConstraint(
            ["inspection_id"],
            ["inspections.id"],
            name="fk_further_videos_inspection_id_inspections",
            ondelete="CASCADE",
        ),
    )
    for name in _TABLES:
        with op.batch_alter_table(name) as table:
            table.add_column(sa.Column("video", sa.Integer(), nullable=False, server_default="0"))


def downgrade() -> None:
    """Drop them; of an inspection of several videos the first is left, and the rows of all."""
    for name in _TABLES:
        with op.batch_alter_table(name) as table:
            table.drop_column("video")
    op.drop_table("further_videos")
