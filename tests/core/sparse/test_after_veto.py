"""After a veto: a graph without the pairs over the weld, its parts mapped, and the larger one gone on with."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pycolmap
import pytest

from core.io.frames import write_frames
from core.scene.frame import Crop
from core.settings import make_settings
from core.stage import Facts, StageResult, StageTask
from core.stages import prune, reduce_parts, section
from core.viewgraph import read_graph
from tests.core.making_rows import run_frames
from tests.core.sparse.scene import HEIGHT, WIDTH, center_errors, make_scene, view_graph, write_graph

N, WELD = 28, 12


class Run:
    """Tasks that follow each other in one folder."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.inputs: dict[str, Path] = {}
        self.facts: dict[str, Facts] = {}

    def add(self, key: str, facts: Facts | None = None) -> Path:
        """Folder of a result that is there already."""
        self.inputs[key], self.facts[key] = self.folder / key, facts or {}
        self.inputs[key].mkdir(parents=True, exist_ok=True)
        return self.inputs[key]

    def go(self, stage: Any, key: str, args: Facts | None = None) -> Facts:
        """Run a stage on everything before it."""
        settings = make_settings("default", {"model.prefer_verified": False})
        inputs, facts = dict(self.inputs), dict(self.facts)
        task = StageTask(key, args or {}, settings, inputs, facts, (), self.add(key))
        result: StageResult = stage.run(task)
        self.facts[key] = result.facts
        return result.facts


def test_the_sides_of_a_weld_are_mapped_alone_and_the_larger_one_wins(tmp_path: Path) -> None:
    scene = make_scene(N, 900)
    run = Run(tmp_path)
    table = view_graph(scene)
    write_graph(tmp_path / "graph", scene, table)
    run.add("graph")
    write_frames(run.add("frames"), run_frames(N, 0.1), Crop(0, 0, WIDTH, HEIGHT, WIDTH, HEIGHT))
    whole = run.go(section, "coarse/seg", {"name": "seg_000_0000_0028", "start": 0, "end": N})
    assert whole["registered_images"] == N
    model = pycolmap.Reconstruction(run.inputs["coarse/seg"] / "model")
    turn = pycolmap.Rigid3d(pycolmap.Rotation3d(np.array([0.0, np.radians(25.0), 0.0])), np.zeros(3))
    for image_id in range(WELD + 2, N + 1):
        image = model.image(image_id)
        model.frame(image.frame_id).set_cam_from_world(image.camera_id, image.cam_from_world() * turn)
    facts = {"best": "seg_000_0000_0028", "vetoed": True, "codes": "bent_model"}
    folder = run.add("reduce_refine", facts) / "model"
    folder.mkdir()
    model.write_binary(folder)
    del run.inputs["coarse/seg"], run.facts["coarse/seg"]

    found = run.go(prune, "prune")
    assert (found["cuts"], found["parts"]) == ([[WELD, WELD + 1]], [[0, WELD + 1], [WELD + 1, N]])
    across = (table.pairs[:, 0] <= WELD) & (table.pairs[:, 1] > WELD)
    assert not read_graph(run.inputs["prune"]).n_inliers[across].any()
    for start, end in found["parts"]:
        name = f"section_000_{start:04d}_{end:04d}"
        facts = run.go(section, f"section/{name}", {"name": name, "start": start, "end": end})
        assert (facts["kind"], facts["registered_images"], facts["vetoed"]) == ("section", end - start, 0)
    chosen = run.go(reduce_parts, "reduce_parts")
    assert (chosen["best"], chosen["kind"]) == (f"section_000_{WELD + 1:04d}_{N:04d}", "section")
    assert [flag["code"] for flag in chosen["flags"]] == ["parts_after_veto"]
    kept = pycolmap.Reconstruction(run.inputs["reduce_parts"] / "model")
    assert sorted(kept.reg_image_ids()) == list(range(WELD + 2, N + 1))
    assert center_errors(kept, scene).max() < 0.05


@pytest.mark.parametrize("name", ["graph", "prune"])
def test_a_case_reads_the_pruned_graph_where_there_is_one(tmp_path: Path, name: str) -> None:
    inputs = {"graph": tmp_path / "graph", name: tmp_path / name}
    task = StageTask("extend", {}, make_settings(), inputs, {}, (), tmp_path)
    assert task.input("prune", "graph") == tmp_path / name
