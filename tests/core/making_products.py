"""Facts of stages for tests that need a few members of them: the others are there, and are zero or empty."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import MISSING, fields
from enum import Enum
from types import NoneType, UnionType
from typing import Any, get_args, get_origin, get_type_hints

from core.products.contract import Facts, Product


def facts_of(kind: type[Product], /, **members: object) -> Facts:
    """The facts of a product with these members, in their JSON form or not."""
    types = get_type_hints(kind)
    missing = [one.name for one in fields(kind) if one.default is MISSING and one.name not in members]
    made: dict[str, Any] = {**{name: _nothing(types[name]) for name in missing}, **members}
    return kind(**made).facts


def _nothing(declared: Any) -> object:
    origin, inner = get_origin(declared), get_args(declared)
    if origin is UnionType and NoneType in inner:
        return None
    if origin is tuple:
        return () if not inner or inner[-1] is Ellipsis else tuple(_nothing(one) for one in inner)
    if origin in (dict, Mapping):
        return {}
    if issubclass(declared, Enum):
        return next(iter(declared))
    return declared()
