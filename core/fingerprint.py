"""Names for results: what went in decides the name, so equal work is never done twice."""

from __future__ import annotations

import hashlib
import json
from pathlib import Path


def canonical_json(value: object) -> str:
    """One text for one value: sorted keys, no spaces, finite numbers only (ValueError otherwise)."""
    return json.dumps(value, sort_keys=True, separators=(",", ":"), allow_nan=False, ensure_ascii=True)


def digest_of(value: object) -> str:
    """SHA-256 (hex) of a JSON value."""
    return hashlib.sha256(canonical_json(value).encode()).hexdigest()


def digest_of_file(path: Path) -> str:
    """SHA-256 (hex) of a file's bytes."""
    with path.open("rb") as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()


def task_fingerprint(stage: str, version: int, settings: object, args: object, inputs: dict[str, str]) -> str:
    """sha256(stage, version, the settings it uses, its arguments, digests of its inputs by name)."""
    return digest_of({"stage": stage, "version": version, "settings": settings, "args": args, "inputs": inputs})
