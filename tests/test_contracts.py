"""Contracts between parts that are words: each is declared once, and nobody else spells it."""

from __future__ import annotations

import ast
import csv
import io
import json
import re
from collections.abc import Iterator
from enum import StrEnum
from functools import cache
from pathlib import Path
from typing import TypeGuard

import pytest

from bench.mutate.command import Fate
from core.flags import Severity, Verdict
from core.products.adjustment import LensDecision
from core.products.front import FocalSource
from core.scene.case import CaseKind, CaseReason, CaseStatus, ConfirmedModel, StartMode
from core.scene.detection import Outcome, PlacementMethod, Reason
from core.scene.frame import Role
from core.states import AttemptOutcome, InspectionState, Queue, RunState, StageState, TaskState, run_state
from store.account_models import Scope
from store.models import ReservationKind
from worker.events import EventKind
from worker.task import StopReason

ROOT = Path(__file__).parents[1]
PACKAGES = ("core", "store", "worker", "api", "cli", "bench")
STATES = {member.value for kind in (InspectionState, RunState, StageState, TaskState) for member in kind}
DECLARED = {
    "state": STATES,
    "severity": {member.value for member in Severity},
    "outcome": {member.value for kind in (Outcome, AttemptOutcome) for member in kind},
    "verdict": {member.value for member in Verdict},
    "reason": {member.value for kind in (Reason, CaseReason) for member in kind},
    "rung": {member.value for member in PlacementMethod},
    "role": {member.value for member in Role},
    "kind": {member.value for kind in (CaseKind, EventKind, ReservationKind) for member in kind},
    "status": {member.value for member in CaseStatus},
    "start_mode": {member.value for member in StartMode},
    "queue": {member.value for member in Queue},
    "stop": {member.value for member in StopReason},
    "stopped": {member.value for member in StopReason},
    "scope": {member.value for member in Scope},
    "fate": {member.value for member in Fate},
    "focal_from": {member.value for member in FocalSource},
    "decision": {member.value for member in LensDecision},
    "kept": {member.value for member in ConfirmedModel},
}
"""Values by the name of the attribute or key that holds them."""
ONLY_DECLARED = {"outcome", "severity", "verdict", "rung", "role", "start_mode"}
"""Names that hold nothing but declared values: a word that is not one of them is misspelt. A `reason` may also be the
code of an error, and others have kinds and statuses too."""
KINDS = (
    *(InspectionState, TaskState, StageState, AttemptOutcome, RunState, Outcome, Severity, Verdict),
    *(Reason, PlacementMethod, Role, CaseKind, CaseStatus, CaseReason, StartMode),
    *(Queue, EventKind, ReservationKind, StopReason, Fate, Scope),
    *(FocalSource, LensDecision, ConfirmedModel),
)
KEY_MODULE = "core/task_key.py"
PUBLISHED = "core/outputs.py"
"""The contract of outputs names the files of stages beside those that it publishes."""
FILE_NAME = re.compile(r"[\w{}.-]+\.(json|npz|csv|ply|png|jpg|glb|db|bin|html)")


@cache
def sources() -> list[tuple[str, ast.Module]]:
    """Every module of the project, parsed once for all rules: that takes longer than a rule."""
    paths = [path for package in PACKAGES for path in sorted((ROOT / package).rglob("*.py"))]
    return [(path.relative_to(ROOT).as_posix(), ast.parse(path.read_text(encoding="utf-8"))) for path in paths]


def spelt(tree: ast.AST) -> Iterator[int]:
    """Lines that compare, assign or pass a declared value as a string."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Compare):
            pairs = [(_name(node.left), right) for right in node.comparators]
        elif isinstance(node, ast.Assign):
            pairs = [(_name(target), node.value) for target in node.targets]
        elif isinstance(node, ast.keyword):
            pairs = [(node.arg, node.value)]
        else:
            continue
        for name, value in pairs:
            found = {text.value for text in ast.walk(value) if isinstance(text, ast.Constant)}
            if found & DECLARED.get(name or "", set()):
                yield node.lineno if hasattr(node, "lineno") else 0


def bare(tree: ast.AST) -> Iterator[int]:
    """Lines that compare a field of declared values with a string, whatever it says, or match it against one."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Compare):
            sides = [node.left, *node.comparators]
            if {_name(side) for side in sides} & ONLY_DECLARED and any(map(_holds_text, sides)):
                yield node.lineno
        elif isinstance(node, ast.Match):
            declared = DECLARED.get(_name(node.subject) or "", set())
            texts = {value.value for case in node.cases for value in ast.walk(case.pattern) if _is_text(value)}
            if texts & declared or (texts and _name(node.subject) in ONLY_DECLARED):
                yield node.lineno


def _holds_text(node: ast.AST) -> bool:
    items = node.elts if isinstance(node, ast.Tuple | ast.List | ast.Set) else [node]
    return any(_is_text(item) and item.value for item in items)


def _is_text(node: ast.AST) -> TypeGuard[ast.Constant]:
    return isinstance(node, ast.Constant) and isinstance(node.value, str)


def _name(node: ast.AST) -> str | None:
    if isinstance(node, ast.Attribute):
        return node.attr
    if isinstance(node, ast.Subscript) and isinstance(node.slice, ast.Constant):
        return str(node.slice.value)
    if isinstance(node, ast.Call) and _name(node.func) == "get" and node.args and _is_text(node.args[0]):
        return str(node.args[0].value)
    return node.id if isinstance(node, ast.Name) else None


def literal_types(tree: ast.AST) -> Iterator[int]:
    """Lines with a ``Literal[...]`` of nothing but declared values."""
    # The setting `windows.start` has words of its own that happen to be two of those for how a case started.
    declared = set().union(*(values for name, values in DECLARED.items() if name != "start_mode"))
    for node in ast.walk(tree):
        if isinstance(node, ast.Subscript) and _name(node.value) == "Literal":
            values = {text.value for text in ast.walk(node.slice) if isinstance(text, ast.Constant)}
            if len(values) > 1 and values <= declared:
                yield node.lineno


def parsed_keys(tree: ast.AST) -> Iterator[int]:
    """Lines that take a task key apart: a call on something named ``key`` with the mark of a part or a model."""
    methods = {"split", "rsplit", "partition", "rpartition", "startswith", "removeprefix", "replace"}
    for node in ast.walk(tree):
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute) and node.func.attr in methods:
            marks = [arg.value for arg in node.args if isinstance(arg, ast.Constant) and isinstance(arg.value, str)]
            if _name(node.func.value) == "key" and any("/" in mark or mark == "@" for mark in marks):
                yield node.lineno


@pytest.mark.parametrize("rule", [spelt, bare, literal_types, parsed_keys])
def test_declared_words_are_spelt_in_their_module_only(rule: object) -> None:
    assert callable(rule)
    found = [f"{path}:{line}" for path, tree in sources() if path != KEY_MODULE for line in rule(tree)]
    assert not found


@pytest.mark.parametrize(
    ("rule", "text"),
    [
        (spelt, 'if task.state == "leased": pass'),
        (spelt, 'if row["state"] in ("queued", "running"): pass'),
        (spelt, 'inspection.state = "failed"'),
        (spelt, 'make(state="waiting")'),
        (spelt, 'if flag["severity"] != "info": pass'),
        (spelt, 'if row.get("status") == "no_model": pass'),
        (spelt, 'unplaced(reason="no_support")'),
        (bare, 'if row.rung == "surfase": pass'),
        (bare, 'if frame["role"] in ("both", other): pass'),
        (bare, 'if "warm" == case.start_mode: pass'),
        (bare, 'match row.status:\n    case "failed": pass'),
        (spelt, 'if event.kind == "finished": pass'),
        (spelt, 'StageSpec(queue="gpu")'),
        (spelt, 'Reservation(kind="upload")'),
        (spelt, 'held.stop = "lost"'),
        (spelt, 'if lens.focal_from != "estimated": pass'),
        (spelt, 'kept = "confirmed"'),
        (literal_types, 'State = Literal["queued", "running"]'),
        (parsed_keys, 'stage = task.key.split("/", 1)[0]'),
        (parsed_keys, 'found = key.startswith("focal/")'),
    ],
)
def test_the_rules_find_what_they_are_for(rule: object, text: str) -> None:
    assert callable(rule)
    assert list(rule(ast.parse(text)))


@pytest.mark.parametrize("kind", KINDS)
def test_a_member_is_written_as_its_value(kind: type[StrEnum]) -> None:
    for member in kind:
        plain = member.value
        assert json.dumps({member: [member]}, indent=1) == json.dumps({plain: [plain]}, indent=1)
        assert f"{member}|{member:>12}" == f"{plain}|{plain:>12}"
        stream = io.StringIO()
        csv.writer(stream).writerow([member])
        assert stream.getvalue() == f"{plain}\r\n"


def test_a_run_ends_as_its_inspection_or_failed() -> None:
    assert run_state(InspectionState.PARTIAL) is RunState.PARTIAL
    assert run_state(InspectionState.CANCELLED) is RunState.CANCELLED
    assert run_state(InspectionState.RUNNING) is RunState.FAILED


def asks_for_the_method(tree: ast.AST) -> list[int]:
    """Lines that read the setting `mapping.method`."""
    return [
        node.lineno
        for node in ast.walk(tree)
        if isinstance(node, ast.Attribute) and node.attr == "method" and _name(node.value) == "mapping"
    ]


def test_a_stage_asks_for_the_mapping_method_once() -> None:
    lines = {path: asks_for_the_method(tree) for path, tree in sources() if path.startswith("core/")}
    assert lines["core/stages/map_defects.py"]
    assert not {path: found for path, found in lines.items() if len(found) > 1}
    assert not [
        path for path, found in lines.items() if found and not path.startswith(("core/stages/", "core/report/"))
    ]


def file_names(tree: ast.AST) -> Iterator[str]:
    """Names of files that code spells, and the folder of a sparse model where a path is joined with it."""
    for node in ast.walk(tree):
        text = node.value if isinstance(node, ast.Constant) and isinstance(node.value, str) else None
        if isinstance(node, ast.JoinedStr):
            text = "".join(str(part.value) if isinstance(part, ast.Constant) else "{}" for part in node.values)
        if text is not None and FILE_NAME.fullmatch(text.rsplit("/", 1)[-1]):
            yield text.rsplit("/", 1)[-1]
        if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Div) and isinstance(node.right, ast.Constant):
            yield from {"model"} & {str(node.right.value)}


def test_a_file_between_stages_is_named_in_one_module() -> None:
    modules: dict[str, set[str]] = {}
    for path, tree in sources():
        if path.startswith("core/") and path != PUBLISHED:
            for name in file_names(tree):
                modules.setdefault(name, set()).add(path)
    assert modules["frames.json"] == {"core/io/frames.py"}, "the rule still finds names"
    assert not {name: found for name, found in modules.items() if len(found) > 1}


@pytest.mark.parametrize(
    ("text", "name"),
    [
        ('read(folder / "frames.json")', "frames.json"),
        ('read(f"{index:04d}.jpg")', "{}.jpg"),
        ('_MESH = "mapping/mesh_defects.ply"', "mesh_defects.ply"),
        ('read(task.input("extend") / "model")', "model"),
    ],
)
def test_names_of_files_are_found(text: str, name: str) -> None:
    assert list(file_names(ast.parse(text))) == [name]
