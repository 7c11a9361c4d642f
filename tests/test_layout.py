"""Modules are as long as one subject needs: none too long, and none so small that one other module is its only use."""

from __future__ import annotations

import ast
from collections import defaultdict
from collections.abc import Mapping
from pathlib import Path

import pytest

from scripts.stage_versions import imported_names

ROOT = Path(__file__).parents[1]
AREAS = ("core", "store", "worker", "api", "cli", "bench")
LEAST = 60
MOST = 400
READERS = ROOT / "core" / "annotations" / "foreign"
"""One module for each format, however short."""


def modules(root: Path) -> dict[str, Path]:
    """Every module of the areas by its dotted name; package files aside."""
    found = {}
    for area in AREAS:
        for path in sorted((root / area).rglob("*.py")):
            if path.name != "__init__.py":
                found[".".join(path.relative_to(root).with_suffix("").parts)] = path
    return found


def importers(known: Mapping[str, Path]) -> dict[str, set[str]]:
    """Which modules import each; tests do not count."""
    found: dict[str, set[str]] = defaultdict(set)
    for name, path in known.items():
        for other in imported_names(ast.parse(path.read_text(encoding="utf-8"))):
            if other in known and other != name:
                found[other].add(name)
    return found


def length(path: Path) -> int:
    """Lines of a file."""
    return path.read_text(encoding="utf-8").count("\n")


def small(root: Path) -> set[str]:
    """Paths of modules under `LEAST` lines that one module imports."""
    known = modules(root)
    users = importers(known)
    return {
        path.relative_to(root).as_posix()
        for name, path in known.items()
        if len(users[name]) == 1 and length(path) < LEAST and READERS not in path.parents
    }


def test_no_module_is_too_long() -> None:
    assert [name for name, path in modules(ROOT).items() if length(path) > MOST] == []


def test_no_small_module_has_a_single_importer() -> None:
    assert small(ROOT) == set()


@pytest.mark.parametrize(("users", "lines", "is_small"), [(1, 59, True), (1, 60, False), (2, 3, False), (0, 3, False)])
def test_the_rule_finds_what_it_is_for(tmp_path: Path, users: int, lines: int, is_small: bool) -> None:
    (tmp_path / "store").mkdir()
    (tmp_path / "store" / "part.py").write_text("x = 1\n" * lines, encoding="utf-8")
    for number in range(users):
        text = "from store import part\n" if number else "def use():\n    from store.part import x\n"
        (tmp_path / "store" / f"user{number}.py").write_text(text + "y = 1\n" * LEAST, encoding="utf-8")
    assert small(tmp_path) == ({"store/part.py"} if is_small else set())
