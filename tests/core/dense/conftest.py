"""The rendered scene, undistorted once for all tests of the dense stages."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from core.settings import make_settings
from core.stage import StageTask
from core.stages import undistort
from tests.core.dense import making_scenes as scenes


@dataclass(frozen=True)
class Undistorted:
    """Result of `undistort` on the rendered scene."""

    folder: Path
    scene: scenes.Scene
    facts: dict[str, Any]
    root: Path


OPTIONS = {"dense.views": 0, "dense.sources": 4, "dense.levels": 2}


@pytest.fixture(scope="session")
def undistorted(tmp_path_factory: pytest.TempPathFactory) -> Undistorted:
    root = tmp_path_factory.mktemp("dense")
    scene, _ = scenes.build(root)
    out = root / "undistort"
    out.mkdir()
    inputs = {"extend": root / "extend", "frames": root / "frames"}
    task = StageTask("undistort", {}, make_settings("default", OPTIONS), inputs, {}, (), out)
    return Undistorted(out, scene, undistort.run(task).facts, root)
