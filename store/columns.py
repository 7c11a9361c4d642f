"""What the tables are declared with: their base class, and types of columns that are the same on all databases."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from datetime import UTC, datetime
from enum import StrEnum
from typing import Any, TypeVar

from sqlalchemy import JSON, DateTime, Dialect, Double, Integer, MetaData, String
from sqlalchemy.orm import DeclarativeBase, mapped_column
from sqlalchemy.types import TypeDecorator, TypeEngine

from core.scene.columns import columns_of


class UtcDateTime(TypeDecorator[datetime]):
    """A moment in UTC, the same on both databases (SQLite keeps no zone)."""

    impl = DateTime
    cache_ok = True

    def process_bind_param(self, value: datetime | None, dialect: Dialect) -> datetime | None:
        """Store as naive UTC."""
        return None if value is None else value.astimezone(UTC).replace(tzinfo=None)

    def process_result_value(self, value: datetime | None, dialect: Dialect) -> datetime | None:
        """Read back with its zone."""
        return None if value is None else value.replace(tzinfo=UTC)


class Choice(TypeDecorator[StrEnum]):
    """One of the values of an enumeration, stored as its text; read back as its member."""

    impl = String
    cache_ok = True

    def __init__(self, kind: type[StrEnum]) -> None:
        super().__init__(16)
        self.kind = kind

    def process_bind_param(self, value: StrEnum | None, dialect: Dialect) -> str | None:
        """Store the plain text."""
        return None if value is None else str(value)

    def process_result_value(self, value: str | None, dialect: Dialect) -> StrEnum | None:
        """Read back as a member."""
        return None if value is None else self.kind(value)


class Base(DeclarativeBase):
    """Names of constraints are fixed, so that migrations can speak of them."""

    metadata = MetaData(
        naming_convention={
            "ix": "ix_%(table_name)s_%(column_0_N_name)s",
            "uq": "uq_%(table_name)s_%(column_0_N_name)s",
            "fk": "fk_%(table_name)s_%(column_0_name)s_%(referred_table_name)s",
            "pk": "pk_%(table_name)s",
        }
    )
    type_annotation_map = {  # noqa: RUF012 - SQLAlchemy reads this class attribute
        datetime: UtcDateTime,
        dict[str, Any]: JSON(none_as_null=True),
        list[str]: JSON,
    }


_TYPES: Mapping[type, type[TypeEngine[Any]]] = {int: Integer, float: Double, str: String}
_T = TypeVar("_T", bound=type[Base])


def with_columns_of(declared: type[Any], also_null: Collection[str] = ()) -> Callable[[_T], _T]:
    """A decorator that gives a table the columns of a published row, as far as the class does not name them itself.

    Args:
        declared: the dataclass that declares the published table; see `core.scene.columns`.
        also_null: columns that may be empty in rows of a former version, though the declaration says otherwise.
    """

    def add(table: _T) -> _T:
        for column in columns_of(declared):
            if column.name not in table.__table__.columns:
                nullable = column.nullable or column.name in also_null
                setattr(table, column.name, mapped_column(_TYPES[column.kind], nullable=nullable))
        return table

    return add
