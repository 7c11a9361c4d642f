"""Zip files of a few small members."""

from __future__ import annotations

import io
import json
import zipfile
from typing import Any


def zipped(files: dict[str, Any]) -> bytes:
    """A zip of texts, bytes, and values as JSON, by name."""
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, value in files.items():
            text = value if isinstance(value, str | bytes) else json.dumps(value)
            archive.writestr(name, text)
    return packed.getvalue()
