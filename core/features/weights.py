"""Network weights as tensors."""

from __future__ import annotations

from typing import Any

import torch

from core.weight_files import weights_file


def load_weights(name: str) -> dict[str, Any]:
    """Tensors of a weights file, read without running code from it."""
    state: dict[str, Any] = torch.load(weights_file(name), map_location="cpu", weights_only=True)
    return state
