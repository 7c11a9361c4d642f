"""Every option in words: what the command line lists and the API serves."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any, get_args, get_origin

from pydantic.fields import FieldInfo

from core.settings.presets import PRESET_NAMES, make_settings, option_names

_LIMITS = (("ge", ">="), ("gt", ">"), ("le", "<="), ("lt", "<"))


@dataclass(frozen=True)
class OptionInfo:
    """One option: its name, meaning, and value in every preset."""

    name: str
    meaning: str
    unit: str
    default: object
    range: str
    source: str
    presets: dict[str, object]
    """Value in each preset that differs from the default."""

    def to_dict(self) -> dict[str, object]:
        """JSON form."""
        return asdict(self)

    def value(self, preset: str) -> object:
        """Value in a preset."""
        return self.presets.get(preset, self.default)


def describe_options() -> list[OptionInfo]:
    """Every option that can be set, in the order of declaration."""
    values = {preset: make_settings(preset).model_dump(mode="json") for preset in PRESET_NAMES}
    described = []
    for name, info in option_names().items():
        extra = info.json_schema_extra if isinstance(info.json_schema_extra, dict) else {}
        default = _at(values["default"], name)
        described.append(
            OptionInfo(
                name=name,
                meaning=str(info.description),
                unit=str(extra.get("unit", "")),
                default=default,
                range=_range(info),
                source=str(extra.get("source", "")),
                presets={p: _at(values[p], name) for p in PRESET_NAMES if _at(values[p], name) != default},
            )
        )
    return described


def _at(tree: Mapping[str, object], name: str) -> object:
    """The value of a dotted name in nested objects."""
    node: Any = tree  # an object at every step but the last
    for part in name.split("."):
        node = node[part]
    return node


def _range(info: FieldInfo) -> str:
    """Allowed values in words: choices, limits or the type."""
    annotation = info.annotation
    kinds = [kind for kind in get_args(annotation) if kind is not type(None)] or [annotation]
    optional = type(None) in get_args(annotation)
    if all(isinstance(kind, str) for kind in kinds):
        text = "|".join(kinds)
    elif kinds[0] is bool:
        text = "true|false"
    else:
        limits = [
            f"{sign} {getattr(item, attribute)}"
            for item in info.metadata
            for attribute, sign in _LIMITS
            if getattr(item, attribute, None) is not None
        ]
        is_list = kinds[-1] is Ellipsis or get_origin(kinds[0]) is tuple
        base = "list of numbers" if is_list else {int: "integer", float: "number"}.get(kinds[0], "text")
        text = " ".join([base, *limits])
    return f"{text} or null" if optional else text
