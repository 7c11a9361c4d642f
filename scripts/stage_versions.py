"""Which code stands behind each stage's version: a change of one without the other does not go unseen.

A stage's version enters the fingerprint of its results. When the code changes and the version does not, old results are
taken for new ones: right when results are the same, wrong otherwise, and nobody sees which. So a hash of the code is
kept beside the version in ``tests/data/stage_versions.json``, and a test compares. The code of a stage is the syntax
tree of its module and of all modules of `core` that it imports, without documentation and annotations.

    make versions                                     after raising versions in core/stage_specs.py
    make versions SAME="sample, draft: no difference"  the results are the same, and how that was compared
"""

from __future__ import annotations

import argparse
import ast
import hashlib
import json
from collections.abc import Iterator
from functools import cache
from pathlib import Path

from core.stage_specs import STAGES

ROOT = Path(__file__).parents[1]
FILE = ROOT / "tests" / "data" / "stage_versions.json"
TYPES = ("__future__", "typing", "collections.abc", "numpy.typing")
"""Modules whose imports serve annotations."""
APART = ("core.settings",)
"""Packages whose changes are no changes of a stage: option values enter the fingerprint themselves."""


def main() -> None:
    """Write the file; exit status 1 when code changed and neither a version nor `--same` says what that means."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--same", default="", metavar="HOW", help="results are the same; how that was compared")
    same = parser.parse_args().same.strip()
    known = recorded()
    unsaid = [name for name, entry in current().items() if needs_word(entry, known.get(name))]
    if unsaid and not same:
        raise SystemExit(
            f"code changed without a new version: {', '.join(unsaid)}\n"
            'raise the versions in core/stage_specs.py, or: make versions SAME="how results were compared"'
        )
    entries = {name: {**entry, **_word(entry, known.get(name), same)} for name, entry in current().items()}
    FILE.write_text(json.dumps(entries, indent=1) + "\n", encoding="utf-8")


def recorded() -> dict[str, dict[str, str | int]]:
    """What the file says: version, code and the word on same results, by stage."""
    found: dict[str, dict[str, str | int]] = json.loads(FILE.read_text(encoding="utf-8")) if FILE.exists() else {}
    return found


def current() -> dict[str, dict[str, str | int]]:
    """Version and code of every stage as they are."""
    return {name: {"version": spec.version, "code": code_of(spec.entry)} for name, spec in STAGES.items()}


def needs_word(now: dict[str, str | int], before: dict[str, str | int] | None) -> bool:
    """Whether the code is another one under the same version."""
    return before is not None and now["version"] == before["version"] and now["code"] != before["code"]


def _word(now: dict[str, str | int], before: dict[str, str | int] | None, same: str) -> dict[str, str | int]:
    if needs_word(now, before):
        return {"same_results": same}
    if before is None or now["version"] != before["version"] or "same_results" not in before:
        return {}
    return {"same_results": before["same_results"]}


def code_of(entry: str) -> str:
    """Hash (16 hex digits) of the code behind ``module:function``."""
    text = "".join(f"{name}\n{_code(name)}\n" for name in sorted(modules_of(entry.partition(":")[0])))
    return hashlib.sha256(text.encode()).hexdigest()[:16]


@cache
def modules_of(module: str) -> frozenset[str]:
    """The module and all of `core` that it imports, at its top or inside functions."""
    found: set[str] = set()
    left = [module]
    while left:
        name = left.pop()
        if name not in found and name.startswith("core.") and not name.startswith(APART):
            found.add(name)
            left += [other for other in imported_names(tree_of(name)) if _path(other) is not None]
    return frozenset(found)


def imported_names(tree: ast.Module) -> Iterator[str]:
    """Names that could be modules which a module imports, wherever in it."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (name.name for name in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module:
            yield node.module
            yield from (f"{node.module}.{name.name}" for name in node.names)


def _path(module: str) -> Path | None:
    path = ROOT.joinpath(*module.split("."))
    candidates = (path / "__init__.py", path.with_name(path.name + ".py"))
    return next((file for file in candidates if file.is_file()), None)


@cache
def tree_of(module: str) -> ast.Module:
    """Syntax tree of a module of this project; ValueError when there is none."""
    path = _path(module)
    if path is None:
        raise ValueError(f"there is no module {module}")
    return ast.parse(path.read_text(encoding="utf-8"))


@cache
def _code(module: str) -> str:
    return code_text(tree_of(module))


def code_text(tree: ast.Module) -> str:
    """What a module does, as text: its syntax tree without documentation, annotations and lines."""
    return ast.dump(_Plain().visit(ast.parse(ast.unparse(tree))))


class _Plain(ast.NodeTransformer):
    """Leaves out what does not change what a program computes."""

    def visit_Expr(self, node: ast.Expr) -> ast.AST | None:
        """Leave out texts that stand alone: documentation of modules, functions and constants."""
        if isinstance(node.value, ast.Constant) and isinstance(node.value.value, str):
            return None
        return self.generic_visit(node)

    def visit_ImportFrom(self, node: ast.ImportFrom) -> ast.AST | None:
        """Leave out what is imported for annotations."""
        return None if node.module in TYPES else node

    def visit_arg(self, node: ast.arg) -> ast.AST:
        """Leave out the annotation of an argument."""
        return ast.arg(arg=node.arg)

    def visit_FunctionDef(self, node: ast.FunctionDef) -> ast.AST:
        """Leave out what it says it returns."""
        node.returns = None
        return self.generic_visit(node)


if __name__ == "__main__":
    main()
