"""Detections have a size: length, width and area on the surface, each with its standard deviation, and their unit."""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision = "0008"
down_revision = "0007"
branch_labels = None
depends_on = None

_NUMBERS = ("length", "length_sigma", "width", "width_sigma", "area", "area_sigma")
_TEXTS = ("length_unit", "size_from")


def upgrade() -> None:
    """Add the columns; rows of before have no size."""
    with op.batch_alter_table("detections") as table:
        for name in _NUMBERS:
            table.add_column(sa.Column(name, sa.Double(), nullable=True))
        for name in _TEXTS:
            table.add_column(sa.Column(name, sa.String(), nullable=True))


def downgrade() -> None:
    """Drop them."""
    with op.batch_alter_table("detections") as table:
        for name in (*_NUMBERS, *_TEXTS):
            table.drop_column(name)
