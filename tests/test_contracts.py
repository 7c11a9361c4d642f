"""Contracts between parts that are words: each is declared once, and nobody else spells it."""

from __future__ import annotations

import ast
import csv
import io
import json
from collections.abc import Iterator
from enum import StrEnum
from pathlib import Path

import pytest

from bench.mutate.command import Fate
from core.flags import Severity, Verdict
from core.mapping.rows import Outcome
from core.states import AttemptOutcome, InspectionState, Queue, RunState, StageState, TaskState, run_state
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
    "queue": {member.value for member in Queue},
    "kind": {member.value for kind in (EventKind, ReservationKind) for member in kind},
    "stop": {member.value for member in StopReason},
    "stopped": {member.value for member in StopReason},
    "fate": {member.value for member in Fate},
}
"""Values by the name of the attribute or key that holds them."""
KINDS = (
    *(InspectionState, TaskState, StageState, AttemptOutcome, RunState, Outcome, Severity, Verdict),
    *(Queue, EventKind, ReservationKind, StopReason, Fate),
)
KEY_MODULE = "core/task_key.py"


def sources() -> Iterator[tuple[str, ast.Module]]:
    for package in PACKAGES:
        for path in sorted((ROOT / package).rglob("*.py")):
            yield path.relative_to(ROOT).as_posix(), ast.parse(path.read_text(encoding="utf-8"))


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


def _name(node: ast.AST) -> str | None:
    if isinstance(node, ast.Attribute):
        return node.attr
    if isinstance(node, ast.Subscript) and isinstance(node.slice, ast.Constant):
        return str(node.slice.value)
    return node.id if isinstance(node, ast.Name) else None


def literal_types(tree: ast.AST) -> Iterator[int]:
    """Lines with a ``Literal[...]`` of nothing but declared values."""
    declared = set().union(*DECLARED.values())
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


@pytest.mark.parametrize("rule", [spelt, literal_types, parsed_keys])
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
        (spelt, 'if event.kind == "finished": pass'),
        (spelt, 'StageSpec(queue="gpu")'),
        (spelt, 'Reservation(kind="upload")'),
        (spelt, 'held.stop = "lost"'),
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
