"""Factories: from deployment settings to what they name, the database with its tables and the artifact store."""

from __future__ import annotations

from functools import partial
from pathlib import Path

from sqlalchemy import URL, text

from store.db import Database, make_engine, open_sqlite, upgrade
from store.files import ArtifactStore
from store.retry import retried_for
from store.settings import DeploymentSettings

_UPGRADE_LOCK = 0x626C6164
"""PostgreSQL's advisory lock under which tables are changed, so that processes may start together."""
_STARTING_S = 60.0
"""How long a database server that is just starting is waited for."""


def open_database(settings: DeploymentSettings) -> Database:
    """The database with its newest tables; waits a minute for a server that is just starting.

    Raises:
        BadInput: it is of a newer version of this program, or a damaged file.
        OperationalError: no server answers.
    """
    if not settings.database_url:
        path = settings.folder("bladeatlas.db")
        path.parent.mkdir(parents=True, exist_ok=True)
        return open_sqlite(path)
    retried_for(_STARTING_S, partial(_upgrade_one_at_a_time, settings.database()))
    return Database(settings.database())


def open_artifacts(settings: DeploymentSettings, folder: str = "") -> ArtifactStore:
    """The artifact store, ``inputs/``, ``results/``, ``inspections/`` and ``logs/`` below one root; or one of these."""
    root = settings.artifacts()
    if isinstance(root, Path):
        return ArtifactStore(root / folder)
    return ArtifactStore(f"{root.rstrip('/')}/{folder}".rstrip("/"), **settings.storage_options())


def _upgrade_one_at_a_time(url: str | URL) -> None:
    engine = make_engine(url)
    try:
        if engine.dialect.name != "postgresql":
            upgrade(url)
            return
        with engine.connect() as connection:
            connection.execute(text("SELECT pg_advisory_lock(:name)"), {"name": _UPGRADE_LOCK})
            upgrade(url)
    finally:
        engine.dispose()
