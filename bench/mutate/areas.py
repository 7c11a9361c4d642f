"""The areas of the code whose tests are measured: their modules and the tests of these."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class Area:
    """Modules and their tests, relative to the repository."""

    modules: tuple[str, ...]
    """Files, or folders of which every module counts."""
    tests: tuple[str, ...]
    """Files or folders, in the order in which they run: the fast ones first."""

    def sources(self, root: Path) -> list[Path]:
        """Every module of the area, sorted, relative to the repository `root`."""
        found = []
        for name in self.modules:
            path = root / name
            found += sorted(path.rglob("*.py")) if path.is_dir() else [path]
        return [path.relative_to(root) for path in found]


AREAS: Mapping[str, Area] = {
    "annotations": Area(
        ("core/annotations", "core/stages/annotations.py"),
        (
            "tests/core/annotations",
            "tests/core/stages/test_annotations.py",
            "tests/core/stages/test_inputs_as_they_come.py",
        ),
    ),
    "defects": Area(
        ("core/timeline", "core/stages/timeline.py"),
        ("tests/core/timeline", "tests/core/test_surface_stages.py", "tests/core/test_mapping_stages.py"),
    ),
    "placement": Area(
        ("core/mapping", "core/stages/map_defects.py"),
        ("tests/core/mapping", "tests/core/test_surface_stages.py", "tests/core/test_mapping_stages.py"),
    ),
    "thesis": Area(("core/thesis",), ("tests/core/thesis", "tests/core/test_mapping_stages.py")),
    "scene": Area(("core/scene", "core/io"), ("tests/core/scene", "tests/core/io")),
    "plan": Area(
        (
            "core/graph.py",
            "core/stage_specs.py",
            "store/plan.py",
            "store/leasing.py",
            "store/advance.py",
            "store/graph.py",
        ),
        (
            "tests/test_stage_versions.py",
            "tests/core/test_graph.py",
            "tests/core/test_stage_settings.py",
            "tests/store/test_graph.py",
            "tests/store/test_leasing.py",
            "tests/store/test_plan.py",
        ),
    ),
    "points": Area(
        ("core/sparse/points.py", "core/sparse/tracks.py", "core/sparse/triangulation.py"),
        (
            "tests/core/sparse/test_triangulation.py",
            "tests/core/sparse/test_tracks.py",
            "tests/core/sparse/test_points.py",
        ),
    ),
}
