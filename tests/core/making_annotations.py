"""Annotation files of a few members, packed and read."""

from __future__ import annotations

import io
import json
import zipfile
from typing import Any

from core.annotations.load import annotations_from
from core.annotations.model import Annotations

FRAME = (960.0, 720.0)
"""Size of the pictures that the examples were made on."""


def zipped(files: dict[str, Any]) -> bytes:
    """A zip of texts, bytes, and values as JSON, by name."""
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, value in files.items():
            text = value if isinstance(value, str | bytes) else json.dumps(value)
            archive.writestr(name, text)
    return packed.getvalue()


def read(value: Any, frame: tuple[float, float] | None = FRAME, form: str = "auto") -> Annotations:
    """The annotations of bytes, a text, or a value as JSON, on frames of a size."""
    data = (
        value if isinstance(value, bytes) else value.encode() if isinstance(value, str) else json.dumps(value).encode()
    )
    return annotations_from(data, frame, form)
