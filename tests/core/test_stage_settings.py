"""What of the settings a stage gets, and that this is what it reads."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from functools import cache

import pytest

from core.settings import Settings, declared_values, make_settings, only_declared
from core.settings.base import Group, UndeclaredOption
from core.stage_specs import STAGES
from scripts.stage_versions import modules_of, tree_of

GROUPS: dict[str, type[Group]] = {
    name: info.annotation
    for name, info in Settings.model_fields.items()
    if isinstance(info.annotation, type) and issubclass(info.annotation, Group)
}
GROUP_OF_CLASS = {kind.__name__: name for name, kind in GROUPS.items()}


def test_another_stages_option_does_not_touch_frames() -> None:
    declared = STAGES["frames"].settings
    plain = declared_values(make_settings(), declared)
    assert declared_values(make_settings(options={"mapping.radius_fraction": 0.02}), declared) == plain


def test_naming_an_own_option_counts_even_at_its_default() -> None:
    """A user's interval outside the video is an error, a preset's is cut: who set it matters."""
    declared = STAGES["frames"].settings
    plain = make_settings("thesis")
    named = make_settings("thesis", {"frames.clip_end_s": plain.frames.clip_end_s})
    assert declared_values(named, declared) != declared_values(plain, declared)


def test_every_stage_declares_known_settings() -> None:
    for name, spec in STAGES.items():
        assert set(declared_values(make_settings(), spec.settings)) == set(spec.settings), name


def test_a_stage_cannot_read_what_it_does_not_declare() -> None:
    own = only_declared(make_settings(options={"mapper.min_model_size": 7}), ("mapper.min_model_size", "roi"))
    assert own.mapper.min_model_size == 7
    assert own.roi == make_settings().roi
    with pytest.raises(UndeclaredOption, match="search_tracks"):
        _ = own.mapper.search_tracks
    with pytest.raises(UndeclaredOption, match="dense"):
        _ = own.dense
    with pytest.raises(UndeclaredOption, match="seed"):
        _ = own.seed
    # A changed copy, as algorithms make, shows no more.
    with pytest.raises(UndeclaredOption):
        _ = own.mapper.model_copy(update={"min_model_size": 3}).search_tracks


@pytest.mark.parametrize("stage", sorted(STAGES))
def test_every_declared_option_is_read_by_the_stage_or_what_it_imports(stage: str) -> None:
    """Else a change of it would make the stage and everything after it again for nothing."""
    module = STAGES[stage].entry.partition(":")[0]
    read = set().union(*(_options_read(name) for name in modules_of(module)))
    unread = [option for option in _single_options(STAGES[stage].settings) if option not in read]
    assert not unread


@pytest.mark.parametrize("stage", sorted(STAGES))
def test_what_a_stage_reads_itself_is_declared(stage: str) -> None:
    """Without running it: an option in a rare branch would end the stage only there."""
    declared = set(_single_options(STAGES[stage].settings))
    module = STAGES[stage].entry.partition(":")[0]
    own = {module, "core.sparse.case_stage"} & modules_of(module)
    read = set().union(*(_options_read(name) for name in own))
    assert read <= declared


def test_the_reading_check_sees_an_option_that_nobody_reads() -> None:
    module = STAGES["fuse"].entry.partition(":")[0]
    read = set().union(*(_options_read(name) for name in modules_of(module)))
    assert "fusion.min_num_pixels" in read
    assert "mesh.poisson_trim" not in read


def _single_options(declared: tuple[str, ...]) -> Iterator[str]:
    for name in declared:
        if name in GROUPS:
            yield from (f"{name}.{option}" for option in GROUPS[name].model_fields)
        else:
            yield name


def _chain(node: ast.expr) -> list[str]:
    """``a.b.c`` as names; empty for anything else."""
    names: list[str] = []
    while isinstance(node, ast.Attribute):
        names.insert(0, node.attr)
        node = node.value
    return [node.id, *names] if isinstance(node, ast.Name) else []


def _group_of_chain(chain: list[str]) -> str | None:
    """``task.settings.model`` -> ``model``."""
    *rest, last = chain or [""]
    return last if rest and rest[-1] == "settings" and last in GROUPS else None


@cache
def _options_read(module: str) -> frozenset[str]:
    """Options that a module reads, by the names under which it holds the settings and their groups."""
    tree = tree_of(module)
    groups: dict[tuple[str, ...], set[str]] = {}
    for node in ast.walk(tree):
        if isinstance(node, ast.arg | ast.AnnAssign) and node.annotation is not None:
            kind = ast.unparse(node.annotation)
            name = node.arg if isinstance(node, ast.arg) else ast.unparse(node.target)
            if kind in GROUP_OF_CLASS:
                groups.setdefault((name,), set()).add(GROUP_OF_CLASS[kind])
    for node in ast.walk(tree):
        if isinstance(node, ast.Assign):
            pairs: list[tuple[ast.expr, ast.expr]] = []
            for target in node.targets:
                if isinstance(target, ast.Tuple) and isinstance(node.value, ast.Tuple):
                    pairs += zip(target.elts, node.value.elts, strict=False)
                else:
                    pairs.append((target, node.value))
            for target, value in pairs:
                held = groups.get(tuple(_chain(value)), set()) | ({_group_of_chain(_chain(value))} - {None})
                if _chain(value)[-1:] == ["settings"]:  # `self._settings = case.settings`
                    held = held | groups.get(("settings",), set())
                if held and _chain(target):
                    groups.setdefault(tuple(_chain(target)), set()).update(str(one) for one in held)
    read: set[str] = set()
    for node in ast.walk(tree):
        chain = _chain(node) if isinstance(node, ast.Attribute) else []
        if len(chain) < 2:
            continue
        *base, option = chain
        known = set(groups.get(tuple(base), set()))
        if _group_of_chain(base):
            known.add(str(_group_of_chain(base)))
        # `case.settings.search_tracks`, where the class of `case` holds `settings: MapperSettings`.
        if base[-1] == "settings":
            known |= {group for name, found in groups.items() if name[-1] == "settings" for group in found}
            if option in Settings.model_fields and option not in GROUPS:
                read.add(option)
        read |= {f"{group}.{option}" for group in known if option in GROUPS[group].model_fields}
    return frozenset(read)
