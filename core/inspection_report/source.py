"""What the report is made of: published files, wherever they lie."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from core.errors import BadInput
from core.json_files import JsonObject
from core.outputs import (
    DEFECTS,
    DETECTIONS,
    DOCUMENT,
    LIMITS,
    QUALITY,
    ROW,
    SUMMARY,
    TIMELINE,
    VIEWER,
    is_of_page,
    path_of_model,
)

ReadFile = Callable[[str], bytes | None]
"""Of a published path, the bytes of the file; None where there is none."""


@dataclass(frozen=True)
class ReportSource:
    """The published objects that the report repeats."""

    read: ReadFile
    summary: JsonObject
    quality: JsonObject
    detections: Sequence[JsonObject]
    timeline: Sequence[JsonObject]
    defects: Sequence[JsonObject]
    rows: Mapping[int, JsonObject]
    """row.json by model; models without one are left out."""
    pages: Mapping[int, JsonObject]
    """viewer.json by model; models without one are left out."""
    limits: JsonObject | None = None
    """limits.json; None where no limits of the shop were told."""

    @property
    def models(self) -> list[int]:
        """Numbers of the models, rising; 0 also where there is none."""
        return _models(self.quality)

    def picture(self, path: str) -> bytes | None:
        """A picture of a page; None where it is not there.

        Raises:
            BadInput: the path is not that of a page's file.
        """
        if not is_of_page(path) or ".." in path.split("/"):
            raise BadInput(f"'{path}' is no picture of a result's page", where=VIEWER)
        return self.read(path)


def files_below(result: Path) -> ReadFile:
    """Reads published files of a result folder; a link that leads out of it is none."""
    root = result.resolve()

    def read(path: str) -> bytes | None:
        file = (root / path).resolve()
        return file.read_bytes() if file.is_file() and file.is_relative_to(root) else None

    return read


def read_source(read: ReadFile) -> ReportSource:
    """Read the published objects.

    Raises:
        BadInput: the result has no summary, or an object is no JSON.
    """
    summary, quality = _object(read, SUMMARY), _object(read, QUALITY)
    if summary is None or quality is None:
        raise BadInput(f"there is no {QUALITY if summary else SUMMARY}: is it a finished result?", where="RESULT")
    models = _models(quality)
    return ReportSource(
        read=read,
        summary=summary,
        quality=quality,
        detections=_list(read, DETECTIONS),
        timeline=_list(read, TIMELINE),
        defects=_list(read, DEFECTS),
        rows=_by_model(read, models, ROW),
        pages=_by_model(read, models, f"{VIEWER}/{DOCUMENT}"),
        limits=_object(read, LIMITS),
    )


def _models(quality: JsonObject) -> list[int]:
    return sorted({0, *(int(one["model"]) for one in quality.get("models") or ())})


def _by_model(read: ReadFile, models: Sequence[int], path: str) -> dict[int, JsonObject]:
    found = {model: _object(read, path_of_model(model, path)) for model in models}
    return {model: value for model, value in found.items() if value is not None}


def _object(read: ReadFile, path: str) -> JsonObject | None:
    value = _json(read, path)
    if value is not None and not isinstance(value, dict):
        raise BadInput(f"{path} holds no JSON object", where=path)
    return value


def _list(read: ReadFile, path: str) -> list[JsonObject]:
    value = _json(read, path)
    if value is None:
        return []
    if not isinstance(value, list) or not all(isinstance(one, dict) for one in value):
        raise BadInput(f"{path} holds no list of JSON objects", where=path)
    return value


def _json(read: ReadFile, path: str) -> object:
    data = read(path)
    try:
        return None if data is None else json.loads(data)
    except ValueError as error:
        raise BadInput(f"{path} is no JSON: {error}", where=path) from None
