"""How a product becomes the facts of its task, and facts a product again: both here and nowhere else.

Facts are small JSON: they steer the plan, fill the report, and with the hashes of the files they make the result's
digest. So their form does not change with the types: results of earlier versions are read, and not computed again.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, fields, is_dataclass
from typing import TypeVar

from pydantic import TypeAdapter, ValidationError

from core.errors import StageFailed
from core.flags import Flag
from core.json_files import JsonObject
from core.task_key import parts_of

Facts = JsonObject
"""The JSON form of a product, as the plan keeps it."""

OMITTED: Mapping[str, bool] = {"omitted": True}
"""Metadata of a field that the facts do not have while it is None; None of any other field is null."""


@dataclass(frozen=True, kw_only=True)
class Product:
    """What a stage hands on beside its files: values free of clock times and machine paths."""

    @property
    def facts(self) -> Facts:
        """The JSON form, keys in the order of the fields."""
        return _object(self)


@dataclass(frozen=True, kw_only=True)
class Findings(Product):
    """What the product of any stage may tell a reader of the result."""

    flags: tuple[Flag, ...] = ()
    checks: tuple[Flag, ...] = ()


P = TypeVar("P", bound=Product)

_ADAPTERS: dict[type[Product], TypeAdapter[Product]] = {}
"""What checks the facts of each kind of product: made when first asked for, which takes a while."""


def read_product(kind: type[P], facts: Mapping[str, object], key: str) -> P:
    """The product of a task from its facts. Members that `kind` does not have are left alone.

    Args:
        kind: type of the product, that of the task's stage.
        facts: as the plan keeps them.
        key: of the task, for the error.

    Raises:
        StageFailed: a member is missing or of another type; the message names the task and the member.
    """
    try:
        product = _adapter(kind).validate_json(json.dumps(facts), strict=True)
    except ValidationError as error:
        first = error.errors()[0]
        place = ".".join(str(part) for part in first["loc"])
        raise StageFailed(f"the facts of {key} cannot be used: {place}: {first['msg']}", where=key) from error
    if not isinstance(product, kind):
        raise TypeError(f"{type(product).__name__} was read for {kind.__name__}")
    return product


@dataclass(frozen=True)
class Products:
    """Products of finished tasks, each read from its facts when it is asked for."""

    by_key: Mapping[str, Mapping[str, object]]
    """Facts by task key."""

    def __contains__(self, key: str) -> bool:
        """Whether the task is finished."""
        return key in self.by_key

    def __iter__(self) -> Iterator[str]:
        """Keys of the tasks, in the plan's order."""
        return iter(self.by_key)

    def find(self, kind: type[P], *keys: str) -> P | None:
        """Product of the first of `keys` that left facts; None where none did."""
        facts = next(((key, self.by_key[key]) for key in keys if self.by_key.get(key)), None)
        return None if facts is None else read_product(kind, facts[1], facts[0])

    def of(self, kind: type[P], *keys: str) -> P:
        """Product of the first of `keys` that left facts; `StageFailed` where none did."""
        found = self.find(kind, *keys)
        if found is None:
            raise StageFailed(f"there are no facts of {' or '.join(keys)}", where=keys[0])
        return found

    def parts(self, kind: type[P], stage: str, submodel: int = 0) -> list[P]:
        """Products of the many tasks of a stage, ordered by key."""
        return self.every(kind, parts_of(self.by_key, stage, submodel))

    def every(self, kind: type[P], keys: Iterable[str]) -> list[P]:
        """Products of tasks that must have left facts, in the order of `keys`."""
        return [self.of(kind, key) for key in keys]


def _object(value: object) -> Facts:
    assert is_dataclass(value)
    members = ((field, getattr(value, field.name)) for field in fields(value))
    return {
        field.name: _json(member)
        for field, member in members
        if member is not None or not field.metadata.get("omitted")
    }


def _json(value: object) -> object:
    if isinstance(value, Flag):
        return value.to_dict()
    if is_dataclass(value):
        return _object(value)
    if isinstance(value, Mapping):
        return {name: _json(member) for name, member in value.items()}
    if isinstance(value, list | tuple):
        return [_json(member) for member in value]
    return value


def _adapter(kind: type[Product]) -> TypeAdapter[Product]:
    if kind not in _ADAPTERS:
        _ADAPTERS[kind] = TypeAdapter(kind)
    return _ADAPTERS[kind]
