"""The code behind a stage does not change without a word on its results."""

from __future__ import annotations

import ast

import pytest

from core.stage_specs import STAGES
from scripts import stage_versions as versions


def test_code_and_versions_are_those_that_are_recorded() -> None:
    """After a change: raise the version in core/stage_specs.py or have compared results, then `make versions`."""
    recorded = versions.recorded()
    now = versions.current()
    assert list(recorded) == list(now)
    changed = [name for name, entry in now.items() if {k: recorded[name][k] for k in ("version", "code")} != entry]
    assert not changed, "make versions"


def test_a_stage_stands_on_what_it_imports() -> None:
    mesh = versions.modules_of(STAGES["mesh"].entry.partition(":")[0])
    assert {"core.stages.mesh", "core.surface.poisson", "core.surface.ply"} <= mesh
    assert "core.settings.groups" not in mesh
    assert "core.sparse.mapper" not in mesh
    assert "core.sparse.mapper" in versions.modules_of("core.stages.refine")


@pytest.mark.parametrize(
    ("line", "same"),
    [
        ("def f(a: int) -> int:\n    'Other words.'\n    return a + 1\n", True),
        ("def f(a):\n    # a comment\n    return (a + 1)\n", True),
        ("def f(a):\n    return a + 2\n", False),
        ("def f(a):\n    return a - 1\n", False),
        ("def f(b):\n    return b + 1\n", False),
    ],
)
def test_words_and_annotations_are_no_code(line: str, same: bool) -> None:
    plain = "def f(a):\n    return a + 1\n"
    assert (versions.code_text(ast.parse(line)) == versions.code_text(ast.parse(plain))) == same


def test_other_code_under_the_same_version_needs_a_word() -> None:
    before: dict[str, str | int] = {"version": 3, "code": "a"}
    assert versions.needs_word({"version": 3, "code": "b"}, before)
    assert not versions.needs_word({"version": 4, "code": "b"}, before)
    assert not versions.needs_word({"version": 3, "code": "a"}, before)
    assert not versions.needs_word({"version": 1, "code": "a"}, None)
