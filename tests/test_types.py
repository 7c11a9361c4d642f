"""What the type checker is kept from seeing: few lines of `core`, no stubs of the vision libraries, no test."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).parents[1]
MAX_ANY_LINES = 85
"""Lines of `core` with the word `Any`, imports included. Each says its reason or has an obvious one."""
STUBBED = ("pycolmap", "cv2", "av", "open3d", "scipy")
"""Libraries that ship types, or have them in `stubs`."""


def settings() -> dict[str, Any]:
    with (ROOT / "pyproject.toml").open("rb") as stream:
        found: dict[str, Any] = tomllib.load(stream)["tool"]["mypy"]
    return found


def any_lines(text: str) -> int:
    return sum(bool(re.search(r"\bAny\b", line)) for line in text.splitlines())


def test_lines_with_any_are_told_from_others() -> None:
    text = "from typing import Any\n\nx: dict[str, Any] = {}  # Any\nAnything = 1\n"
    assert any_lines(text) == 2


def test_core_says_any_on_few_lines() -> None:
    found = {path: any_lines(path.read_text(encoding="utf-8")) for path in sorted((ROOT / "core").rglob("*.py"))}
    assert len(found) > 100, "the package is there"
    most = sorted(found.items(), key=lambda item: -item[1])[:5]
    assert sum(found.values()) <= MAX_ANY_LINES, [(path.relative_to(ROOT).as_posix(), count) for path, count in most]


@pytest.mark.parametrize("library", STUBBED)
def test_no_library_with_types_is_skipped(library: str) -> None:
    for override in settings()["overrides"]:
        names = {name.split(".")[0] for name in override["module"]}
        loose = {"follow_imports", "ignore_missing_imports", "ignore_errors"} & set(override)
        assert not (loose and library in names), override["module"]


def test_every_package_and_the_tests_are_checked_strictly() -> None:
    mypy = settings()
    packages = {path.parent.name for path in ROOT.glob("*/__init__.py")} | {"tests", "migrations"}
    assert packages - set(mypy["packages"]) <= {"scripts"}, "a module of it is named apart"
    assert mypy["strict"] is True
    weaker = {name for name, value in mypy.items() if name.startswith(("disallow_", "warn_", "check_")) and not value}
    assert weaker == set()
