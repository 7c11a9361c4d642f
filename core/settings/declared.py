"""The part of a run's settings that a stage declares: all that it gets to see, and all that names its result."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from core.settings.base import Group
from core.settings.presets import Settings


def only_declared(settings: Settings, names: Iterable[str]) -> Settings:
    """The settings without anything that is not named; whoever reads something else gets an `UndeclaredOption`.

    Args:
        settings: of the run.
        names: groups (``mapper``), single options (``mapper.min_model_size``) or plain values (``seed``). With
            ``overrides`` go the names of the declared options that the user set.
    """
    chosen = tuple(names)
    whole = {name for name in chosen if "." not in name}
    found: dict[str, object] = {name: getattr(settings, name) for name in whole}
    single: dict[str, list[str]] = {}
    for name in chosen:
        group, _, option = name.partition(".")
        if option and group not in whole:
            single.setdefault(group, []).append(option)
    for group, options in single.items():
        found[group] = _with_only(getattr(settings, group), options)
    if "overrides" in whole:
        # Those of other stages must not touch this one.
        found["overrides"] = tuple(name for name in settings.overrides if _is_declared(name, chosen))
    made = _made_of(Settings, found)
    assert isinstance(made, Settings)
    return made


def declared_values(settings: Settings, names: Iterable[str]) -> dict[str, object]:
    """The values of `only_declared` as JSON by declared name, for the fingerprint of a stage's result."""
    chosen = tuple(names)
    own = only_declared(settings, chosen)
    return {name: _json(_value(own, name)) for name in chosen}


def _is_declared(option: str, names: tuple[str, ...]) -> bool:
    return option in names or option.partition(".")[0] in names


def _with_only(group: Group, options: Iterable[str]) -> Group:
    return _made_of(type(group), {name: getattr(group, name) for name in options})


def _made_of(kind: type[Group], values: Mapping[str, object]) -> Group:
    """A group that lacks what is not in `values`; values are valid already, so nothing is checked again."""
    made = kind.model_construct(None, **values)
    for name in [name for name in made.__dict__ if name not in values]:
        del made.__dict__[name]
    return made


def _value(settings: Settings, name: str) -> object:
    value: object = settings
    for part in name.split("."):
        value = getattr(value, part)
    return value


def _json(value: object) -> object:
    if isinstance(value, Group):
        return value.model_dump(mode="json")
    return list(value) if isinstance(value, tuple) else value
