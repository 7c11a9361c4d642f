"""Network weights as tensors."""

from __future__ import annotations

import torch

from core.weight_files import weights_file


def load_weights(name: str, part: str = "") -> dict[str, torch.Tensor]:
    """Tensors of a weights file, or of a part of it, by name; read without running code from it."""
    content = torch.load(weights_file(name), map_location="cpu", weights_only=True)
    tensors: dict[str, torch.Tensor] = content[part] if part else content
    return tensors
