"""Options and presets: what a run can be asked for."""

from __future__ import annotations

from typing import Any

from fastapi import APIRouter
from pydantic import BaseModel, ConfigDict, Field

from core.settings import PRESET_NAMES, Settings, make_settings
from core.settings.describe import describe_options

router = APIRouter(prefix="/v1", tags=["options"])

_OPTION_EXAMPLE: dict[str, Any] = {
    "name": "matching.window",
    "meaning": "each frame is paired with this many following frames",
    "unit": "frames",
    "default": 5,
    "range": "integer >= 1",
    "source": "thesis",
    "presets": {},
}


class Option(BaseModel):
    """One option in words."""

    model_config = ConfigDict(json_schema_extra={"example": _OPTION_EXAMPLE})

    name: str = Field(description="dotted name, as in `--set name=value`")
    meaning: str
    unit: str = Field(description="unit of the value, empty for a bare number")
    default: Any = Field(description="value in the preset `default`")
    range: str = Field(description="allowed values in words")
    source: str = Field(description="where the default comes from")
    presets: dict[str, Any] = Field(description="value in each preset that differs")


class Options(BaseModel):
    """All options, in the order of the method."""

    model_config = ConfigDict(json_schema_extra={"example": {"options": [_OPTION_EXAMPLE]}})

    options: list[Option]


class Presets(BaseModel):
    """Every preset's full settings and their JSON Schema."""

    presets: dict[str, dict[str, Any]] = Field(description="preset and all its values")
    json_schema: dict[str, Any] = Field(description="JSON Schema of these settings")


class Preset(BaseModel):
    """One preset's full settings."""

    name: str
    settings: dict[str, Any]


@router.get("/options", summary="Every option: meaning, unit, default, range, source")
def options() -> Options:
    """List all options; a run refuses any other name."""
    return Options(options=[Option(**option.to_dict()) for option in describe_options()])


@router.get("/presets", summary="Presets and the JSON Schema of settings")
def presets() -> Presets:
    """Every preset with all its values."""
    values = {name: make_settings(name).model_dump(mode="json") for name in PRESET_NAMES}
    return Presets(presets=values, json_schema=Settings.model_json_schema())


@router.get("/presets/{name}", summary="One preset")
def preset(name: str) -> Preset:
    """All values of one preset; 422 for an unknown name."""
    return Preset(name=name, settings=make_settings(name).model_dump(mode="json"))
