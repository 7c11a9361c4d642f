"""Our own form of annotations as types: the reader's own, and what the published JSON Schema is made from.

What a single value may be, and the words that refuse it, are those of `core.annotations.checks`.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated, Any, TypeVar

from pydantic import (
    BaseModel,
    BeforeValidator,
    ConfigDict,
    FailFast,
    Field,
    PlainValidator,
    RootModel,
    ValidationError,
    WithJsonSchema,
)
from pydantic_core import PydanticCustomError

from core.annotations import checks
from core.errors import BadInput
from core.geometry.boxes import Box
from core.scene.detection import Polygon

M = TypeVar("M", bound=BaseModel)

_SHARE = {"type": "number", "minimum": 0, "maximum": 1}
_TEXT = {"type": "string", "minLength": 1, "pattern": r"^[^\u0000]*[^\s\u0000][^\u0000]*$"}
_CORNER = {"type": "array", "items": _SHARE, "minItems": 2, "maxItems": 2, "description": "[x, y]"}
_POLYGON = {"type": "array", "items": _CORNER}
TIME_PATTERN = r"^(\+?([0-9]+(\.[0-9]*)?|\.[0-9]+)([eE][+-]?[0-9]{1,2})?|[0-9]{1,4}:[0-5][0-9]:[0-5][0-9](\.[0-9]*)?)$"
"""Of a time key: seconds, or HH:MM:SS.fff. The reader takes spaces around them, too."""


def _by(check: Callable[[Any, str], Any]) -> Callable[[Any], Any]:
    """A validator that refuses what a check refuses, with its words and its place within the value."""

    def validate(value: Any) -> Any:
        try:
            return check(value, "")
        except BadInput as error:
            context = {"what": str(error.context["what"]), "where": error.where, "code": error.code}
            raise PydanticCustomError("refused", "{what}", context) from None

    return validate


def _null_is_empty(value: Any) -> Any:
    """Null is a list without members, as tools write it where they found nothing."""
    return [] if value is None else value


def _optional_polygon(value: Any, where: str) -> Polygon | None:
    return None if value is None else checks.as_polygon(value, where)


Label = Annotated[str, PlainValidator(_by(checks.as_label)), WithJsonSchema(_TEXT)]


class MaskForm(BaseModel):
    """A labelled region. Masks with the label `blade` mark the metal."""

    model_config = ConfigDict(title="Mask")

    label: Label = Field(description="what it is")
    polygon: Annotated[Polygon, PlainValidator(_by(checks.as_polygon)), WithJsonSchema(_POLYGON)] = Field(
        description="corners [x, y] as shares of the whole source frame; fewer than three enclose nothing"
    )


class DetectionForm(BaseModel):
    """One thing that was found."""

    model_config = ConfigDict(title="Detection")

    label: Label = Field(description="what it is")
    bbox: Annotated[
        Box,
        PlainValidator(_by(checks.as_box)),
        WithJsonSchema({"type": "array", "items": _SHARE, "minItems": 4, "maxItems": 4}),
    ] = Field(
        description="[left, upper, right, lower] as shares of the whole source frame; left < right, upper < lower"
    )
    polygon: Annotated[
        Polygon | None,
        PlainValidator(_by(_optional_polygon)),
        WithJsonSchema({"anyOf": [_POLYGON, {"type": "null"}]}),
    ] = Field(None, description="outline; without one, that of the mask that fits")
    score: Annotated[
        float | None,
        PlainValidator(_by(checks.as_score)),
        WithJsonSchema({"anyOf": [_SHARE, {"type": "null"}]}),
    ] = Field(None, description="how sure the detector is")
    track_id: Annotated[
        str | int | None,
        PlainValidator(_by(checks.as_track_id)),
        WithJsonSchema({"anyOf": [_TEXT, {"type": "integer"}, {"type": "null"}]}),
    ] = Field(None, description="detections with the same one are of one object by the tracker")


class EntryForm(BaseModel):
    """Everything at one time."""

    model_config = ConfigDict(title="Entry")

    masks: Annotated[
        list[MaskForm],
        FailFast(),
        BeforeValidator(_null_is_empty, json_schema_input_type=list[MaskForm] | None),
    ] = Field([], description="labelled regions; null is an empty list")
    detections: Annotated[
        list[DetectionForm],
        FailFast(),
        BeforeValidator(_null_is_empty, json_schema_input_type=list[DetectionForm] | None),
    ] = Field([], description="what was found; empty or null where somebody looked and found nothing")


class AnnotationsForm(RootModel[dict[Annotated[str, Field(pattern=TIME_PATTERN, max_length=40)], EntryForm]]):
    """Annotations of a video by time key."""

    model_config = ConfigDict(title="Annotations")


def as_form(kind: type[M], value: Any, path: str) -> M:
    """A value as one of the types here.

    Args:
        kind: the type.
        value: as JSON gives it.
        path: of the value, for messages.

    Raises:
        BadInput: names the path of the first value that is wrong.
    """
    try:
        return kind.model_validate(value)
    except ValidationError as error:
        raise _refusal(error, path) from None


def _refusal(error: ValidationError, path: str) -> BadInput:
    first = error.errors(include_url=False)[0]
    place = path + "".join(f"[{part}]" if isinstance(part, int) else f".{part}" for part in first["loc"])
    value, context = first["input"], first.get("ctx", {})
    if first["type"] == "refused":
        return checks.invalid(place + context["where"], context["what"], context["code"])
    if first["type"] == "missing":
        kind = "a text that is not empty" if first["loc"][-1] == "label" else "a list"
        return checks.invalid(place, f"must be {kind}, not null")
    kind = "a list" if first["type"] == "list_type" else "an object"
    return checks.invalid(place, f"must be {kind}, not {checks.shown(value)}")


def json_schema() -> dict[str, Any]:
    """JSON Schema (2020-12) of a file of our own form.

    It accepts nothing that the reader refuses, but for what a schema cannot say: that a box has its left before its
    right and its upper before its lower side, that a key occurs once, and that a track is 7 and not 7.0.
    """
    schema = AnnotationsForm.model_json_schema(mode="validation")
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "description": "Annotations of a borescope video: what somebody, or a detector, found in it. "
        "Further members are ignored.",
        **{name: part for name, part in schema.items() if name != "description"},
        "additionalProperties": False,
    }
