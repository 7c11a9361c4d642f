"""Columns of the published tables, as the class of a table's row declares them.

A row is a frozen dataclass: its fields are the columns in their order, the docstring below a field says what the column
means. The database, the description of the HTTP interface and the page of the documentation read them here, or are
compared with them by a test.
"""

from __future__ import annotations

import ast
import inspect
import textwrap
from collections.abc import Mapping
from dataclasses import dataclass, fields, is_dataclass
from enum import StrEnum
from itertools import pairwise
from types import NoneType, UnionType
from typing import Any, Union, get_args, get_origin, get_type_hints

_WORDS: Mapping[type, str] = {int: "integer", float: "number", str: "text"}


@dataclass(frozen=True)
class Column:
    """One column of a published table."""

    name: str
    kind: type
    """``int``, ``float`` or ``str``; an enumeration counts as the text that its members are written as."""
    nullable: bool
    """True where a row may leave it empty."""
    meaning: str

    @property
    def kind_in_words(self) -> str:
        """The type as the documentation names it."""
        return _WORDS[self.kind] + (" or empty" if self.nullable else "")


def columns_of(declared: type[Any]) -> tuple[Column, ...]:
    """Columns of the table whose rows are of this dataclass; those of a field that is a dataclass stand in its place.

    Raises:
        TypeError: a field is neither a number nor a text, or can be more than one of them.
    """
    kinds, meanings = get_type_hints(declared), _docstrings(declared)
    found: list[Column] = []
    for field in fields(declared):
        kind = kinds[field.name]
        if is_dataclass(kind) and isinstance(kind, type):
            found += columns_of(kind)
        else:
            found.append(_column(field.name, kind, meanings.get(field.name, "")))
    return tuple(found)


def _column(name: str, kind: Any, meaning: str) -> Column:
    given = get_args(kind) if get_origin(kind) in (Union, UnionType) else (kind,)
    plain = {str if isinstance(one, type) and issubclass(one, StrEnum) else one for one in given if one is not NoneType}
    if len(plain) != 1 or not plain <= _WORDS.keys():
        raise TypeError(f"column {name} is declared as {kind}: a table holds whole numbers, numbers and texts")
    return Column(name, plain.pop(), NoneType in given, meaning)


def _docstrings(declared: type[Any]) -> dict[str, str]:
    """The texts below the fields of a class and of those that it extends, read from the source: Python keeps none."""
    found = {}
    for kind in reversed([one for one in declared.__mro__ if is_dataclass(one)]):
        (tree,) = ast.parse(textwrap.dedent(inspect.getsource(kind))).body
        assert isinstance(tree, ast.ClassDef)  # the source of a class is one
        for field, below in pairwise(tree.body):
            if isinstance(field, ast.AnnAssign) and isinstance(field.target, ast.Name) and isinstance(below, ast.Expr):
                text = below.value
                if isinstance(text, ast.Constant) and isinstance(text.value, str):
                    found[field.target.id] = " ".join(text.value.split())
    return found
