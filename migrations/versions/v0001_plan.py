"""The plan, its results, and the rows that stages write."""

from __future__ import annotations

from typing import Any

import sqlalchemy as sa
from alembic import op

revision = "0001"
down_revision = None
branch_labels = None
depends_on = None


def upgrade() -> None:
    """Make the tables."""
    _inspections()
    _tasks()
    _attempts()
    _results()
    _cases()
    _detections()
    _events()
    _defects()
    _metrics()


def downgrade() -> None:
    """Drop them, children first."""
    for table in ("metrics", "defects", "events", "detections", "cases", "results", "attempts", "tasks", "inspections"):
        op.drop_table(table)


def _text(name: str, length: int | None = None, null: bool = False) -> sa.Column[Any]:
    return sa.Column(name, sa.String(length), nullable=null)


def _int(name: str, null: bool = False) -> sa.Column[Any]:
    return sa.Column(name, sa.Integer(), nullable=null)


def _real(name: str, null: bool = False) -> sa.Column[Any]:
    return sa.Column(name, sa.Double(), nullable=null)


def _json(name: str, null: bool = False) -> sa.Column[Any]:
    return sa.Column(name, sa.JSON(), nullable=null)


def _time(name: str, null: bool = False) -> sa.Column[Any]:
    return sa.Column(name, sa.DateTime(), nullable=null)


def _bytes(name: str, null: bool = False) -> sa.Column[Any]:
    return sa.Column(name, sa.BigInteger(), nullable=null)


def _of_inspection(table: str) -> sa.ForeignKeyConstraint:
    name = f"fk_{table}_inspection_id_inspections"
    return sa.ForeignKeyConstraint(["inspection_id"], ["inspections.id"], name=name, ondelete="CASCADE")


def _row_table(table: str, key: sa.Column[Any], *columns: sa.Column[Any]) -> None:
    """A table of rows that one task of one inspection wrote."""
    op.create_table(
        table,
        _text("inspection_id", 64),
        _text("task_key", 128),
        key,
        *columns,
        sa.PrimaryKeyConstraint("inspection_id", key.name, name=f"pk_{table}"),
        _of_inspection(table),
    )


def _inspections() -> None:
    op.create_table(
        "inspections",
        _text("id", 64),
        _text("state", 16),
        _text("video_path"),
        _text("video_sha256", 64),
        _text("annotations_path", null=True),
        _text("annotations_sha256", 64, null=True),
        _text("input_digest", 64),
        _json("settings"),
        _text("out"),
        _text("failed_stage", 64, null=True),
        _json("error", null=True),
        _json("previous"),
        _time("created_at"),
        _time("started_at", null=True),
        _time("ended_at", null=True),
        _time("updated_at"),
        sa.PrimaryKeyConstraint("id", name="pk_inspections"),
    )
    op.create_index("ix_inspections_state", "inspections", ["state"])


def _tasks() -> None:
    op.create_table(
        "tasks",
        _int("id"),
        _text("inspection_id", 64),
        _text("key", 128),
        _text("stage", 64),
        _text("queue", 16),
        _int("position"),
        _json("args"),
        _json("depends"),
        sa.Column("optional", sa.Boolean(), nullable=False),
        _text("state", 16),
        _text("fingerprint", 64, null=True),
        _int("attempt"),
        _int("fence"),
        _text("lease_owner", 128, null=True),
        _time("lease_expires_at", null=True),
        _time("started_at", null=True),
        _time("ended_at", null=True),
        _real("seconds", null=True),
        _bytes("peak_rss_bytes", null=True),
        _real("progress"),
        _text("message", 256),
        sa.Column("reused", sa.Boolean(), nullable=False),
        _text("digest", 64, null=True),
        _json("facts", null=True),
        _json("error", null=True),
        sa.PrimaryKeyConstraint("id", name="pk_tasks"),
        sa.UniqueConstraint("inspection_id", "key", name="uq_tasks_inspection_id_key"),
        _of_inspection("tasks"),
        sqlite_autoincrement=True,
    )
    op.create_index("ix_tasks_fingerprint", "tasks", ["fingerprint"])
    op.create_index("ix_tasks_state_lease_expires_at", "tasks", ["state", "lease_expires_at"])


def _attempts() -> None:
    op.create_table(
        "attempts",
        _int("id"),
        _text("inspection_id", 64),
        _int("task_id"),
        _text("key", 128),
        _int("fence"),
        _int("attempt"),
        _text("owner", 128),
        _text("fingerprint", 64),
        _time("started_at"),
        _time("ended_at", null=True),
        _text("outcome", 16),
        _real("seconds", null=True),
        _bytes("peak_rss_bytes", null=True),
        _json("error", null=True),
        sa.PrimaryKeyConstraint("id", name="pk_attempts"),
        sa.UniqueConstraint("task_id", "fence", name="uq_attempts_task_id_fence"),
        _of_inspection("attempts"),
        sqlite_autoincrement=True,
    )
    op.create_index("ix_attempts_inspection_id", "attempts", ["inspection_id"])


def _results() -> None:
    op.create_table(
        "results",
        _text("fingerprint", 64),
        _text("stage", 64),
        _text("digest", 64),
        _json("facts"),
        _json("rows"),
        _text("path"),
        _real("seconds"),
        _bytes("peak_rss_bytes"),
        _time("created_at"),
        sa.PrimaryKeyConstraint("fingerprint", name="pk_results"),
    )


def _cases() -> None:
    _row_table(
        "cases",
        _text("name", 64),
        _text("kind", 16),
        _int("start"),
        _int("end"),
        _text("status", 16),
        _text("reason", null=True),
        _int("frames"),
        _int("models"),
        _int("registered_images"),
        _int("points3D"),
        _real("mean_reprojection_error_px", null=True),
        _real("median_reprojection_error_px", null=True),
        _real("seconds"),
        _text("start_mode", 16, null=True),
        _int("selected"),
    )


def _detections() -> None:
    _row_table(
        "detections",
        _int("id"),
        _text("key"),
        _real("time_s", null=True),
        _text("label"),
        _real("score", null=True),
        *(_real(name) for name in ("box_x1", "box_y1", "box_x2", "box_y2")),
        _int("frame_index", null=True),
        _text("outcome", 16),
        _text("reason", 64, null=True),
        _text("rung", 16, null=True),
        _int("support_points", null=True),
        *(_real(name, null=True) for name in ("x", "y", "z", "confidence")),
        _text("blade", null=True),
        _int("defect_id", null=True),
        _int("model", null=True),
    )


def _events() -> None:
    _row_table(
        "events",
        _int("event_id"),
        _int("defect_id", null=True),
        _text("label"),
        _real("start_s"),
        _real("end_s"),
        _int("n_detections"),
        _int("n_frames"),
        *(_real(name, null=True) for name in ("x", "y", "z", "radius", "confidence")),
    )


def _defects() -> None:
    _row_table(
        "defects",
        _int("id"),
        _text("label"),
        *(_real(name, null=True) for name in ("x", "y", "z")),
        _json("record"),
    )


def _metrics() -> None:
    _row_table("metrics", _text("name", 192), _real("value"))
