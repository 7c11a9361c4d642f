"""Keys belong to accounts, which have quotas, turns, sessions and an audit log.

Every old key gets an account of its own, and what was made without keys belongs to the account `default`.
"""

from __future__ import annotations

from datetime import UTC, datetime
from typing import Any

import sqlalchemy as sa
from alembic import op

revision = "0006"
down_revision = "0005"
branch_labels = None
depends_on = None

_DEFAULT = "default"
_OWNED = ("inspections", "uploads", "reservations", "idempotency_keys")
_OLD_SCOPES = ["read", "submit", "review"]
"""All that a key could do before."""
_HIGHEST_PRIORITY = 9


def upgrade() -> None:
    """Make the table of accounts and fill it.

    An account has the id of the key that it is made for, which is what the column `owner` held already.
    """
    accounts = _accounts()
    now = datetime.now(UTC).replace(tzinfo=None)
    op.bulk_insert(accounts, [{"id": _DEFAULT, "name": _DEFAULT, "created_at": now, "max_priority": _HIGHEST_PRIORITY}])
    op.execute(
        "INSERT INTO accounts (id, name, created_at, max_priority) "
        f"SELECT id, name, created_at, {_HIGHEST_PRIORITY} FROM api_keys"
    )
    with op.batch_alter_table("api_keys") as table:
        table.add_column(sa.Column("account_id", sa.String(64), nullable=True))
        table.add_column(sa.Column("scopes", sa.JSON(), nullable=True))
        table.add_column(sa.Column("expires_at", sa.DateTime(), nullable=True))
    op.get_bind().execute(
        sa.text("UPDATE api_keys SET account_id = id, scopes = :scopes").bindparams(
            sa.bindparam("scopes", _OLD_SCOPES, type_=sa.JSON())
        )
    )
    with op.batch_alter_table("api_keys") as table:
        table.alter_column("account_id", existing_type=sa.String(64), nullable=False)
        table.alter_column("scopes", existing_type=sa.JSON(), nullable=False)
        table.create_foreign_key("fk_api_keys_account_id_accounts", "accounts", ["account_id"], ["id"])
        table.create_index("ix_api_keys_account_id", ["account_id"])
    for name in _OWNED:
        op.execute(f"UPDATE {name} SET owner = '{_DEFAULT}' WHERE owner = ''")
    with op.batch_alter_table("inspections") as table:
        for column in _inspection_columns():
            table.add_column(column)
    _sessions()
    _request_counts()
    _audit()
    op.execute(
        "UPDATE inspections SET published_bytes = "
        "(SELECT coalesce(sum(size), 0) FROM artifacts WHERE artifacts.inspection_id = inspections.id)"
    )


def downgrade() -> None:
    """Drop it all; what an account has belongs then to one of its keys: its first, or else the oldest that is valid."""
    for account, owner in _owners().items():
        for name in _OWNED:
            statement = sa.text(f"UPDATE {name} SET owner = :owner WHERE owner = :account")
            op.get_bind().execute(statement.bindparams(owner=owner, account=account))
    for name in ("audit", "request_counts", "sessions"):
        op.drop_table(name)
    with op.batch_alter_table("inspections") as table:
        for column in _inspection_columns():
            table.drop_column(column.name)
    with op.batch_alter_table("api_keys") as table:
        table.drop_constraint("fk_api_keys_account_id_accounts", type_="foreignkey")
        table.drop_index("ix_api_keys_account_id")
        for name in ("account_id", "scopes", "expires_at"):
            table.drop_column(name)
    op.drop_table("accounts")


def _owners() -> dict[str, str]:
    """The key that stands for each account; empty for `default` when it has none."""
    oldest_valid_first = "SELECT account_id, id FROM api_keys ORDER BY revoked_at IS NOT NULL, created_at, id"
    found: dict[str, str] = {_DEFAULT: ""}
    for account, key in op.get_bind().execute(sa.text(oldest_valid_first)):
        if not found.get(account) or account == key:
            found[account] = key
    return found


def _inspection_columns() -> list[sa.Column[Any]]:
    return [
        sa.Column("priority", sa.Integer(), nullable=False, server_default="0"),
        sa.Column("input_bytes", sa.BigInteger(), nullable=False, server_default="0"),
        sa.Column("published_bytes", sa.BigInteger(), nullable=False, server_default="0"),
        sa.Column("reuse_account", sa.String(64), nullable=False, server_default=""),
    ]


def _accounts() -> sa.Table:
    return op.create_table(
        "accounts",
        sa.Column("id", sa.String(64), nullable=False),
        sa.Column("name", sa.String(128), nullable=False),
        sa.Column("created_at", sa.DateTime(), nullable=False),
        sa.Column("closed_at", sa.DateTime(), nullable=True),
        sa.Column("retention_days", sa.Double(), nullable=True),
        sa.Column("max_priority", sa.Integer(), nullable=False),
        sa.Column("max_active", sa.Integer(), nullable=True),
        sa.Column("max_open_uploads", sa.Integer(), nullable=True),
        sa.Column("max_promised_bytes", sa.BigInteger(), nullable=True),
        sa.Column("max_kept_bytes", sa.BigInteger(), nullable=True),
        sa.Column("max_requests_per_minute", sa.Integer(), nullable=True),
        sa.Column("turn_at", sa.DateTime(), nullable=True),
        sa.PrimaryKeyConstraint("id", name="pk_accounts"),
    )


def _sessions() -> None:
    op.create_table(
        "sessions",
        sa.Column("digest", sa.String(64), nullable=False),
        sa.Column("key_id", sa.String(64), nullable=False),
        sa.Column("created_at", sa.DateTime(), nullable=False),
        sa.Column("expires_at", sa.DateTime(), nullable=False),
        sa.ForeignKeyConstraint(["key_id"], ["api_keys.id"], name="fk_sessions_key_id_api_keys"),
        sa.PrimaryKeyConstraint("digest", name="pk_sessions"),
    )
    op.create_index("ix_sessions_key_id", "sessions", ["key_id"])
    op.create_index("ix_sessions_expires_at", "sessions", ["expires_at"])


def _request_counts() -> None:
    op.create_table(
        "request_counts",
        sa.Column("owner", sa.String(64), nullable=False),
        sa.Column("minute", sa.DateTime(), nullable=False),
        sa.Column("taken", sa.Integer(), nullable=False),
        sa.PrimaryKeyConstraint("owner", "minute", name="pk_request_counts"),
    )


def _audit() -> None:
    op.create_table(
        "audit",
        sa.Column("id", sa.Integer(), nullable=False),
        sa.Column("at", sa.DateTime(), nullable=False),
        sa.Column("account_id", sa.String(64), nullable=False),
        sa.Column("key_id", sa.String(64), nullable=False),
        sa.Column("action", sa.String(128), nullable=False),
        sa.Column("target", sa.String(256), nullable=False),
        sa.Column("status", sa.Integer(), nullable=False),
        sa.Column("code", sa.String(64), nullable=False),
        sa.Column("request_id", sa.String(64), nullable=False),
        sa.Column("times", sa.Integer(), nullable=False),
        sa.PrimaryKeyConstraint("id", name="pk_audit"),
        sqlite_autoincrement=True,
    )
    op.create_index("ix_audit_account_id_id", "audit", ["account_id", "id"])
    op.create_index("ix_audit_at", "audit", ["at"])
