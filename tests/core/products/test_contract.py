"""Products as facts and back, and the one error of facts that cannot be used."""

from __future__ import annotations

import ast
import importlib
import inspect
import json
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from types import UnionType
from typing import get_args, get_type_hints

import pytest

import core
from core.errors import StageFailed
from core.flags import Flag, Severity
from core.products.contract import Product, Products, read_product
from core.products.front import BridgeProduct, CameraProduct, FramesProduct, ProbeProduct, VideoLength
from core.products.search import (
    ConfirmProduct,
    ExtendProduct,
    NoPartProduct,
    PassedProduct,
    Ranked,
    ReducerProduct,
    ReverifyProduct,
)
from core.stage_specs import STAGES
from tests.core.making_products import facts_of

ROOT = Path(core.__file__).parents[1]
FLAG = Flag("bent_model", Severity.WARNING, 3.0, 1.5, "frames 3-9")


@pytest.mark.parametrize("name", STAGES)
def test_a_stage_returns_the_product_that_its_spec_names(name: str) -> None:
    module, _, function = STAGES[name].entry.partition(":")
    declared = get_type_hints(getattr(importlib.import_module(module), function))["return"]
    kinds = get_args(declared) if isinstance(declared, UnionType) else (declared,)
    product = STAGES[name].product
    assert declared is product or (len(kinds) > 1 and all(issubclass(kind, product) for kind in kinds))


KINDS: set[type[Product]] = {spec.product for spec in STAGES.values()} | {PassedProduct, NoPartProduct}


@pytest.mark.parametrize("kind", sorted(KINDS, key=str))
def test_every_product_comes_back_from_its_facts(kind: type[Product]) -> None:
    facts = facts_of(kind)
    product = read_product(kind, json.loads(json.dumps(facts)), "x")
    assert type(product) is kind
    assert json.dumps(product.facts) == json.dumps(facts)


def test_members_that_are_omitted_and_nested_ones_come_back_too() -> None:
    length = VideoLength(n_frames=3, duration_s=0.5)
    facts = facts_of(ProbeProduct, flags=(FLAG,), videos=(length, length))
    assert facts["videos"] == [{"n_frames": 3, "duration_s": 0.5}] * 2
    assert facts["flags"] == [FLAG.to_dict()]
    assert read_product(ProbeProduct, facts, "probe").flags == (FLAG,)
    assert "videos" not in facts_of(ProbeProduct)
    assert facts_of(BridgeProduct, gaps=((3, 7),))["gaps"] == [[3, 7]]
    asked = facts_of(PassedProduct, ranking=(Ranked(name="a", verified_detections=2, registered_images=9, points3D=8),))
    assert list(asked["ranking"][0]) == ["name", "verified_detections", "registered_images", "points3D"]


def test_the_lens_stands_before_the_counts_of_its_graph() -> None:
    assert list(facts_of(ReverifyProduct))[:3] == ["model", "width", "height"]
    assert list(facts_of(ReverifyProduct))[-1] == "median_triangulation_angle_deg"


ADJUSTED = """{"rounds": 2, "stable": false, "error_before_px": 0.6, "error_after_px": 0.5,
 "principal_point": {"decision": "uncertain", "sigma_px": [3.5, 2.0], "shift_px": [1.0, -4.0]},
 "radial_terms": {"decision": "significant", "number": 1, "first": 3.25, "second": null},
 "alignment": {"observations": 900, "aligned": 850, "median_shift_px": 0.25},
 "trimming": {"rounds": 9, "kept": 400, "median_error_px": 0.25, "focal_before_px": 400.0, "focal_after_px": 410.0,
 "shift": 0.02499999999999991}}"""
"""As results of 0.2.0 hold it."""
SIMPLE = """{"rounds": 3, "stable": true, "error_before_px": 0.6, "error_after_px": 0.5,
 "principal_point": {"decision": "off", "sigma_px": null, "shift_px": null},
 "radial_terms": {"decision": "off", "number": 2, "first": null, "second": null},
 "alignment": null, "trimming": null}"""


@pytest.mark.parametrize("text", [ADJUSTED, SIMPLE, "null"])
def test_the_final_adjustment_comes_back_as_it_is_stored(text: str) -> None:
    stored = {**facts_of(ExtendProduct), "adjustment": json.loads(text)}
    product = read_product(ExtendProduct, stored, "extend")
    assert json.dumps(product.facts) == json.dumps(stored)
    adjustment = product.adjustment
    assert (adjustment is None) == (text == "null")
    if text == ADJUSTED:
        assert adjustment is not None
        assert adjustment.trimming is not None
        assert adjustment.trimming.shift == 410.0 / 400.0 - 1.0
        assert not adjustment.principal_point.refined


@pytest.mark.parametrize(("kind", "member"), [(CameraProduct, "focal_from"), (ConfirmProduct, "kept")])
def test_a_state_that_is_not_declared_is_refused(kind: type[Product], member: str) -> None:
    with pytest.raises(StageFailed, match=f"the facts of x cannot be used: {member}: Input should be"):
        read_product(kind, {**facts_of(kind), member: "guessed"}, "x")


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"n_search": "60"}, "the facts of frames cannot be used: n_search: Input should be a valid integer"),
        ({"crop": [0, 0, 9]}, "the facts of frames cannot be used: crop.3: Field required"),
        ({"still_share": None}, "the facts of frames cannot be used: still_share"),
    ],
)
def test_facts_that_cannot_be_used_are_one_error_with_task_and_member(change: dict[str, object], says: str) -> None:
    with pytest.raises(StageFailed, match=says) as raised:
        Products({"frames": {**facts_of(FramesProduct), **change}}).of(FramesProduct, "frames")
    assert raised.value.where == "frames"


def test_a_missing_member_is_named_and_one_of_a_later_version_is_left_alone() -> None:
    facts = facts_of(FramesProduct, n_frames=7)
    assert read_product(FramesProduct, {**facts, "of_a_later_version": 1}, "frames").n_frames == 7
    del facts["n_search"]
    with pytest.raises(StageFailed, match="the facts of frames cannot be used: n_search: Field required"):
        read_product(FramesProduct, facts, "frames")


def test_products_are_found_by_key_and_by_stage() -> None:
    facts = {
        "reduce_parts": facts_of(NoPartProduct, why="none passed"),
        "part/b": facts_of(ReducerProduct, best="b"),
        "part/a": facts_of(ReducerProduct, best="a"),
        "part@1/a": facts_of(ReducerProduct, best="further"),
        "nothing": {},
    }
    products = Products(facts)
    assert list(products) == list(facts)
    assert "nothing" in products
    assert products.find(ReducerProduct, "nothing") is None
    assert products.of(NoPartProduct, "nothing", "reduce_parts").why == "none passed"
    assert [one.best for one in products.parts(ReducerProduct, "part")] == ["a", "b"]
    assert [one.best for one in products.parts(ReducerProduct, "part", 1)] == ["further"]
    with pytest.raises(StageFailed, match="there are no facts of x or nothing"):
        products.of(ReducerProduct, "x", "nothing")


@cache
def _sources() -> list[tuple[Path, ast.Module]]:
    paths = [
        path for name in ("core", "store", "worker", "api", "cli", "bench") for path in (ROOT / name).rglob("*.py")
    ]
    return [(path, ast.parse(path.read_text(encoding="utf-8"))) for path in paths]


def _is_facts(node: ast.AST) -> bool:
    """Whether an expression is the facts of tasks, or of one: ``facts``, ``x.facts``, ``x.facts[key]``."""
    if isinstance(node, ast.Subscript):
        return _is_facts(node.value)
    name = node.id if isinstance(node, ast.Name) else node.attr if isinstance(node, ast.Attribute) else ""
    return name == "facts"


def reads_by_text(tree: ast.Module) -> list[int]:
    """Lines that look into facts by a key in quotes, which no type checker sees."""
    found = []
    for node in ast.walk(tree):
        if isinstance(node, ast.Subscript) and _is_facts(node.value):
            key: ast.AST | None = node.slice
        elif isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute) and node.func.attr == "get":
            key = node.args[0] if node.args and _is_facts(node.func.value) else None
        else:
            continue
        if isinstance(key, ast.Constant) and isinstance(key.value, str):
            found.append(key.lineno)
    return found


def test_nobody_looks_into_facts_by_a_key_in_quotes() -> None:
    assert {path.name: lines for path, tree in _sources() if (lines := reads_by_text(tree))} == {}
    wrong = 'task.facts["frames"]["n_frames"]\nfacts.get("best")\nfacts[key].get("x")'
    assert sorted(reads_by_text(ast.parse(wrong))) == [1, 1, 2, 3]


def asked_kinds(tree: ast.Module) -> Iterator[tuple[str, str]]:
    """(name of the type, task key) of every product that is asked for with a key in quotes."""
    for node in ast.walk(tree):
        if not (isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute)):
            continue
        if node.func.attr in ("of", "find", "parts") and node.args and isinstance(node.args[0], ast.Name):
            for key in node.args[1:]:
                if isinstance(key, ast.Constant) and isinstance(key.value, str):
                    yield node.args[0].id, key.value


def test_who_asks_for_a_product_names_the_type_of_the_stage() -> None:
    wrong, asked = [], 0
    for path, tree in _sources():
        if path.is_relative_to(ROOT / "bench" / "soak"):  # a graph of its own
            continue
        for name, key in asked_kinds(tree):
            module = importlib.import_module(".".join(path.relative_to(ROOT).with_suffix("").parts))
            kind = getattr(module, name, None)
            if not (isinstance(kind, type) and issubclass(kind, Product)):
                continue
            product = STAGES[key].product
            asked += 1
            if not (issubclass(kind, product) or issubclass(product, kind)) and not _is_view(kind, product):
                wrong.append((path.name, name, key))
    assert (wrong, asked > 30) == ([], True)


def _is_view(kind: type[Product], product: type[Product]) -> bool:
    """Whether a type reads part of what a product has."""
    return set(inspect.signature(kind).parameters) <= set(inspect.signature(product).parameters)
