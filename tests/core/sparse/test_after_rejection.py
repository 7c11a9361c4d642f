"""After a rejection: the graph without the pairs over the weld and its parts mapped, or all of it with another lens."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pycolmap
import pytest

from core.errors import NoReconstruction
from core.features.io import write_features
from core.geometry.lens import PERSPECTIVE
from core.io.frames import write_frames
from core.products.contract import Facts, Product
from core.products.front import FocalProduct, FramesProduct
from core.products.search import NoPartProduct, RefinedProduct
from core.scene.case import GRAPHS
from core.scene.frame import Crop
from core.settings import make_settings, only_declared
from core.stage import StageTask
from core.stage_specs import STAGES
from core.stages import focal, perspective, prune, reduce_parts, reduce_perspective, reverify, section
from core.task_key import stage_of
from core.verification import CameraFields, read_camera
from core.viewgraph import read_graph
from tests.core.making_products import facts_of
from tests.core.making_rows import run_frames
from tests.core.sparse.scene import HEIGHT, LENS, WIDTH, center_errors, make_scene, view_graph, write_graph

N, WELD = 28, 12
FEW, FOCAL = 16, 340.0
TRUE: CameraFields = {
    "model": "SIMPLE_RADIAL",
    "width": WIDTH,
    "height": HEIGHT,
    "params": [FOCAL, WIDTH / 2, HEIGHT / 2, -0.03],
}
SIZES = facts_of(
    FramesProduct,
    crop=(0, 0, WIDTH, HEIGHT),
    source_width=WIDTH,
    source_height=HEIGHT,
    n_frames=FEW,
    n_search=FEW,
)
REJECTED = facts_of(RefinedProduct, best="seg_000_0000_0016", end=FEW, vetoed=True, codes="bent_model")
WHY = "every model was vetoed by the checks"


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
        options = {"model.prefer_verified": False, "camera.focal_span": 14, "camera.focal_spans": 1}
        settings = only_declared(make_settings("default", options), STAGES[stage_of(key)].settings)
        inputs, facts = dict(self.inputs), dict(self.facts)
        task = StageTask(key, args or {}, settings, inputs, facts, (), self.add(key))
        product: Product = stage.run(task)
        self.facts[key] = product.facts
        return self.facts[key]


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
    facts = {**REJECTED, "best": "seg_000_0000_0028"}
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


@pytest.mark.parametrize("name", GRAPHS)
def test_a_case_reads_the_last_graph_that_there_is(tmp_path: Path, name: str) -> None:
    inputs = {key: tmp_path / key for key in GRAPHS[GRAPHS.index(name) :]}
    task = StageTask("extend", {}, make_settings(), inputs, {}, (), tmp_path)
    assert task.input(*GRAPHS) == tmp_path / name


def test_the_perspective_lens_is_found_and_the_cameras_with_it(tmp_path: Path) -> None:
    scene = make_scene(FEW, 700, lens=TRUE)
    run = Run(tmp_path)
    write_frames(run.add("frames", SIZES), run_frames(FEW), Crop(0, 0, WIDTH, HEIGHT, WIDTH, HEIGHT))
    features = run.add("features/000")
    for frame, found in enumerate(scene.features):
        write_features(features / f"{frame:04d}.npz", found)
    run.add("reduce_refine", REJECTED)
    run.add("reduce_parts", facts_of(NoPartProduct, why=WHY))
    taken_for_fisheye = replace(scene, lens=LENS)
    table = view_graph(taken_for_fisheye)
    write_graph(tmp_path / "graph", taken_for_fisheye, table)
    run.add("graph")

    start = run.go(focal, f"focal/{PERSPECTIVE}-100.0", {"fov_deg": 100.0, "model": str(PERSPECTIVE)})
    assert start["focal_px"] == pytest.approx(FOCAL, rel=0.03)
    lens = run.go(reverify, "reverify", {"model": str(PERSPECTIVE)})
    assert (lens["model"], lens["focal_from"], lens["agreement"]) == ("SIMPLE_RADIAL", "estimated", 1.0)
    assert read_camera(run.inputs["reverify"]).model_name == "SIMPLE_RADIAL"
    again = read_graph(run.inputs["reverify"])
    assert again.pairs.tolist() == table.pairs.tolist()
    assert again.n_inliers.sum() > 0.8 * table.n_inliers.sum()

    name = "perspective_000_0000_0016"
    case = run.go(perspective, f"perspective/{name}", {"name": name, "start": 0, "end": FEW})
    assert (case["kind"], case["registered_images"], case["vetoed"]) == ("perspective", FEW, 0)
    chosen = run.go(reduce_perspective, "reduce_perspective")
    assert (chosen["best"], [flag["code"] for flag in chosen["flags"]]) == (name, ["perspective_after_veto"])
    model = pycolmap.Reconstruction(run.inputs["reduce_perspective"] / "model")
    assert np.median(center_errors(model, scene)) < 0.01


@pytest.mark.parametrize("starts", [[], [facts_of(FocalProduct, fov_deg=70.0, model="SIMPLE_RADIAL", focal_px=400.0)]])
def test_without_a_perspective_lens_the_run_stays_refused_for_what_it_was(starts: list[Facts], tmp_path: Path) -> None:
    run = Run(tmp_path)
    run.add("frames", SIZES)
    run.add("reduce_parts", facts_of(NoPartProduct, why=WHY))
    for start in starts:
        run.add(f"focal/{PERSPECTIVE}-070.0", start)
    with pytest.raises(NoReconstruction, match=f"{WHY}; no perspective lens was found either"):
        run.go(reverify, "reverify", {"model": str(PERSPECTIVE)})
