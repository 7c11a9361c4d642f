"""Database: engines that are safe to crash, sessions that commit or roll back, tables through Alembic only."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from alembic import command
from alembic.config import Config
from alembic.runtime.migration import MigrationContext
from alembic.script import ScriptDirectory
from filelock import FileLock
from sqlalchemy import URL, Connection, Engine, create_engine, event, func, make_url, select
from sqlalchemy.dialects import postgresql, sqlite
from sqlalchemy.exc import DatabaseError, OperationalError
from sqlalchemy.orm import DeclarativeBase, Session

import migrations
from core.errors import BadInput, DiskFull

_BUSY_MS = 30_000


def sqlite_url(path: Path) -> URL:
    """URL of a SQLite file; an object, because as text a path with ``?`` would be cut."""
    return URL.create("sqlite+pysqlite", database=str(path))


def make_engine(url: str | URL) -> Engine:
    """Engine for `url`; a plain ``postgresql://`` is taken to psycopg 3."""
    parsed = make_url(url)
    if parsed.drivername in ("postgres", "postgresql"):
        parsed = parsed.set(drivername="postgresql+psycopg")
    if parsed.get_backend_name() != "sqlite":
        return create_engine(parsed, pool_pre_ping=True)
    engine = create_engine(parsed, connect_args={"timeout": _BUSY_MS / 1000, "check_same_thread": False})
    event.listen(engine, "connect", _prepare_sqlite)
    event.listen(engine, "begin", _begin_sqlite)
    return engine


def _prepare_sqlite(connection: Any, _record: object) -> None:
    # Python's driver would open transactions by itself and late; `_begin_sqlite` does it, see below.
    connection.isolation_level = None
    for pragma in (f"busy_timeout={_BUSY_MS}", "journal_mode=WAL", "synchronous=FULL", "foreign_keys=ON"):
        connection.execute(f"PRAGMA {pragma}").close()


def _begin_sqlite(connection: Connection) -> None:
    # A writer takes the write lock at once: two that read first and write later would deadlock into an error.
    writes = connection.get_execution_options().get("bladeatlas_write", False)
    connection.exec_driver_sql("BEGIN IMMEDIATE" if writes else "BEGIN")


def insert_into(session: Session, table: type[DeclarativeBase]) -> sqlite.Insert | postgresql.Insert:
    """An INSERT that may say what happens to a row that is there already; each database has its own."""
    return sqlite.insert(table) if session.get_bind().dialect.name == "sqlite" else postgresql.insert(table)


class Database:
    """An engine with its two kinds of transaction."""

    def __init__(self, url: str | URL) -> None:
        self.engine = make_engine(url)
        self._writer = self.engine.execution_options(bladeatlas_write=True)
        self.is_sqlite = self.engine.dialect.name == "sqlite"
        self._turn = threading.RLock()
        """Of this process's writers on SQLite: there they would ask for its lock again and again, with growing pauses
        in which others come first."""

    @contextmanager
    def read(self) -> Iterator[Session]:
        """A transaction that only looks."""
        with Session(self.engine, expire_on_commit=False) as session:
            yield session

    @contextmanager
    def snapshot(self) -> Iterator[Session]:
        """A transaction that only looks, and sees one moment however often it does."""
        with self.read() as session:
            if not self.is_sqlite:  # there every transaction is of this kind
                session.connection(execution_options={"isolation_level": "REPEATABLE READ"})
            yield session

    @contextmanager
    def write(self) -> Iterator[Session]:
        """A transaction that commits when the block ends well and rolls back otherwise."""
        try:
            with self._in_turn(), Session(self._writer, expire_on_commit=False) as session, session.begin():
                yield session
        except OperationalError as error:
            if self.is_sqlite and _is_full(error):
                raise DiskFull("the plan cannot be written: no space left on its disk", where="plan") from error
            raise

    @contextmanager
    def _in_turn(self) -> Iterator[None]:
        """Wait for the other writers of this process; after as long as SQLite would wait it is left to SQLite."""
        held = self.is_sqlite and self._turn.acquire(timeout=_BUSY_MS / 1000)
        try:
            yield
        finally:
            if held:
                self._turn.release()

    def now(self, session: Session) -> datetime:
        """The time that leases are measured with: the server's, so that machines need not agree."""
        if self.is_sqlite:
            return datetime.now(UTC)
        moment: datetime = session.execute(select(func.clock_timestamp())).scalar_one()
        return moment.astimezone(UTC)

    def lock(self, session: Session, number: int) -> None:
        """Wait for other transactions that hold this number, and hold it to the end of this one.

        On SQLite one writing transaction follows the other anyway.
        """
        if not self.is_sqlite:
            session.execute(select(func.pg_advisory_xact_lock(number)))

    def close(self) -> None:
        """Give all connections back."""
        self.engine.dispose()


def _is_full(error: OperationalError) -> bool:
    """True for what SQLite says when its disk takes no more."""
    return any(words in str(error.orig) for words in ("disk is full", "disk I/O error", "readonly database"))


def alembic_config(url: str | URL) -> Config:
    """Alembic's configuration, without a file."""
    config = Config()
    # Alembic reads options through a parser that takes % for a reference.
    config.set_main_option("script_location", str(Path(migrations.__file__).parent).replace("%", "%%"))
    config.attributes["url"] = url
    return config


def upgrade(url: str | URL) -> None:
    """Bring the tables to the newest revision; does nothing when they are.

    Raises:
        BadInput: the tables are of a newer version of this program.
    """
    engine = make_engine(url)
    try:
        with engine.connect() as connection:
            current = MigrationContext.configure(connection).get_current_revision()
    finally:
        engine.dispose()
    script = ScriptDirectory.from_config(alembic_config(url))
    known = {revision.revision for revision in script.walk_revisions()}
    if current is not None and current not in known:
        raise BadInput("the database was written by a newer version of bladeatlas", code="newer_database", where="plan")
    if current != script.get_current_head():
        command.upgrade(alembic_config(url), "head")


def open_sqlite(path: Path) -> Database:
    """Open the SQLite file at `path`, made and upgraded when needed, one process at a time.

    Raises:
        DiskFull: there is no space for it.
        BadInput: it is damaged, or of a newer version of this program.
    """
    with FileLock(path.with_name(path.name + ".lock"), fallback_to_soft=False):
        try:
            upgrade(sqlite_url(path))
        except DatabaseError as error:
            if isinstance(error, OperationalError) and _is_full(error):
                raise DiskFull("the plan cannot be written: no space left on its disk", where="plan") from error
            message = f"'{path}' is damaged; without it, finished results are found again by their files"
            raise BadInput(message, code="damaged_plan", where="plan") from error
    return Database(sqlite_url(path))
