"""Media types of the files that an inspection publishes."""

from __future__ import annotations

from pathlib import PurePosixPath

_BY_SUFFIX = {
    ".bin": "application/octet-stream",
    ".csv": "text/csv; charset=utf-8",
    ".glb": "model/gltf-binary",
    ".html": "text/html; charset=utf-8",
    ".jpg": "image/jpeg",
    ".json": "application/json",
    ".pdf": "application/pdf",
    ".ply": "application/ply",
    ".png": "image/png",
    ".txt": "text/plain; charset=utf-8",
}


def media_type(path: str) -> str:
    """By the name's suffix; bytes without a known one are just bytes."""
    return _BY_SUFFIX.get(PurePosixPath(path).suffix.lower(), "application/octet-stream")
