"""Where the small files of kinds that went wrong lie."""

from __future__ import annotations

from pathlib import Path

INPUTS = Path(__file__).parent / "data" / "inputs"
