"""Depth maps of the rendered scene against closed form; consistency; fusion; the half pixel."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from types import ModuleType

import cv2  # noqa: F401  (before pycolmap)
import numpy as np
import pycolmap
import pytest

from core.dense.cuda import patch_match_options, resolve_method
from core.dense.geometric import GeometricFilter
from core.dense.maps import DepthMap, open_scene, read_map, write_map
from core.dense.stereo import PhotometricStereo
from core.dense.workspace import read_maps, write_maps, write_patch_match_config, write_workspace
from core.errors import BadInput, StageFailed
from core.products.contract import Facts
from core.settings import make_settings
from core.stage import StageTask
from core.stages import depth as depth_stage
from core.stages import fuse as fuse_stage
from core.stages import geometric as geometric_stage
from core.surface.ply import read_mesh
from tests.core.dense.conftest import OPTIONS, Undistorted

pytestmark = pytest.mark.slow

Chain = tuple[
    dict[str, Path],
    dict[str, Facts],
    Callable[[ModuleType, str, Mapping[str, int], Mapping[str, Path]], tuple[Path, Facts]],
]


def _truth(undistorted: Undistorted, name: str) -> tuple[np.ndarray, np.ndarray]:
    """Closed-form depth and camera-frame normals of an undistorted view."""
    scene = open_scene(undistorted.folder)
    pin, pose = scene.pinhole, scene.poses[name]
    v, u = np.mgrid[0 : pin.height, 0 : pin.width]
    rays = np.stack([(u + 0.5 - pin.cx) / pin.focal_px, (v + 0.5 - pin.cy) / pin.focal_px, np.ones(u.shape)], -1)
    t, normals = undistorted.scene.hit(pose.center, rays.reshape(-1, 3) @ pose.R)
    return t.reshape(u.shape), (normals @ pose.R.T).reshape(*u.shape, 3)


@pytest.fixture(scope="module")
def chain(undistorted: Undistorted) -> Chain:
    """Stages depth and geometric over all views, in two chunks."""
    settings, root = make_settings("default", OPTIONS), undistorted.root
    facts: dict[str, Facts] = {}

    def run(stage: ModuleType, key: str, args: Mapping[str, int], inputs: Mapping[str, Path]) -> tuple[Path, Facts]:
        out = root / key
        out.mkdir(parents=True)
        task = StageTask(key, args, settings, inputs, facts, (), out)
        return out, stage.run(task).facts

    inputs = {"undistort": undistorted.folder}
    chunks = [("000", {"start": 0, "end": 3}), ("001", {"start": 3, "end": 6})]
    for number, args in chunks:
        inputs[f"depth/{number}"], facts[f"depth/{number}"] = run(
            depth_stage, f"depth/{number}", args, {"undistort": undistorted.folder}
        )
    done = dict(inputs)
    for number, args in chunks:
        key = f"geometric/{number}"
        inputs[key], facts[key] = run(geometric_stage, key, args, done)
    return inputs, facts, run


def test_photometric_depth_is_right_nearly_everywhere(undistorted: Undistorted, chain: Chain) -> None:
    inputs, facts, _ = chain
    assert facts["depth/000"]["method"] == "cpu"
    found = read_map(inputs["depth/000"] / "0002.jpg.npz")
    depth, _ = _truth(undistorted, "0002.jpg")
    have = found.depth > 0
    error = np.abs(found.depth - depth)[have] / depth[have]
    assert have.mean() > 0.6
    assert np.median(error) < 0.003
    assert (error < 0.02).mean() > 0.85


def test_geometric_maps_keep_what_is_right(undistorted: Undistorted, chain: Chain) -> None:
    inputs, _, _ = chain
    before, after = (read_map(inputs[f"{s}/000"] / "0002.jpg.npz") for s in ("depth", "geometric"))
    depth, normal = _truth(undistorted, "0002.jpg")
    have = after.depth > 0
    error = np.abs(after.depth - depth)[have] / depth[have]
    assert (error < 0.01).mean() > 0.9
    assert have.sum() > 0.6 * (before.depth > 0).sum()
    angle = np.degrees(np.arccos(np.clip((after.normal * normal).sum(-1)[have], -1, 1)))
    assert np.median(angle) < 6
    assert (after.cost[have] <= 0.7).all()
    assert (after.cost[~have] == 2).all()


def test_filter_needs_sources_that_agree(undistorted: Undistorted, chain: Chain) -> None:
    inputs, _, _ = chain
    scene = open_scene(undistorted.folder)
    own = {"0002.jpg": inputs["depth/000"] / "0002.jpg.npz"}
    settings = make_settings("default", OPTIONS).dense
    view = next(view for view in scene.views if view.name == "0002.jpg")
    alone = GeometricFilter(scene, settings, own, 0).depth_map(view)
    assert alone.valid_share == 0
    lenient = settings.model_copy(update={"min_consistent": 0})
    assert GeometricFilter(scene, lenient, own, 0).depth_map(view).valid_share > 0.4


def test_result_does_not_depend_on_threads_but_on_the_seed(undistorted: Undistorted) -> None:
    scene = open_scene(undistorted.folder)
    settings = make_settings("default", OPTIONS).dense

    def digest(seed: int, threads: int) -> str:
        found = PhotometricStereo(scene, settings, seed, threads).depth_map(scene.views[1])
        return hashlib.sha256(found.depth.tobytes() + found.normal.tobytes()).hexdigest()

    one = digest(0, 1)
    assert digest(0, 2) == one
    assert digest(1, 1) != one


def test_fused_cloud_lies_on_the_scene(undistorted: Undistorted, chain: Chain) -> None:
    inputs, facts, run = chain
    out, fused = run(fuse_stage, "fuse", {}, inputs)
    cloud = read_mesh(out / "fused.ply")
    assert fused == {"n_points": len(cloud.vertices), "method": "cpu"}
    assert cloud.normals is not None
    assert cloud.colors is not None
    assert "unit: model units" in cloud.comments
    assert [path.name for path in out.iterdir()] == ["fused.ply"]
    scene = undistorted.scene
    to_sphere = np.abs(np.linalg.norm(cloud.vertices - scene.center, axis=1) - scene.radius)
    distance = np.minimum(to_sphere, np.abs(cloud.vertices[:, 2] - scene.wall))
    assert len(cloud.vertices) > 3000
    assert np.median(distance) < 0.02
    assert (distance < 0.08).mean() > 0.9
    assert facts["geometric/001"]["n_views"] == 3


def test_exact_maps_fuse_to_the_surface_only_with_the_half_pixel(undistorted: Undistorted, tmp_path: Path) -> None:
    scene = open_scene(undistorted.folder)
    medians = {}
    for offset in (0.0, 0.5):
        workspace = tmp_path / f"ws{offset}"
        write_workspace(workspace, scene.folder, scene.views)
        if offset:
            model = pycolmap.Reconstruction(str(workspace / "sparse"))
            for camera in model.cameras.values():
                camera.params = np.add(camera.params, [0, 0, 0.5, 0.5])
            model.write(str(workspace / "sparse"))
        for view in scene.views:
            depth, normal = _truth(undistorted, view.name)
            cost = np.zeros(depth.shape, np.float32)
            write_maps(workspace, view.name, DepthMap(depth.astype(np.float32), normal.astype(np.float32), cost))
        options = pycolmap.StereoFusionOptions()
        options.num_threads, options.min_num_pixels = 1, 3
        out = tmp_path / "cloud.ply"
        pycolmap.stereo_fusion(str(out), str(workspace), options=options, output_type="PLY")
        points = read_mesh(out).vertices
        on_sphere = np.linalg.norm(points - undistorted.scene.center, axis=1)
        near = np.abs(on_sphere - undistorted.scene.radius) < 0.1
        medians[offset] = float(np.median(np.abs(on_sphere[near] - undistorted.scene.radius)))
    assert medians[0.0] < 0.5 * medians[0.5]


def test_maps_survive_both_file_formats(tmp_path: Path) -> None:
    rng = np.random.default_rng(0)
    normal = rng.normal(size=(9, 13, 3))
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    depth = rng.uniform(1, 2, (9, 13)).astype(np.float32)
    depth[2, 3] = 0
    found = DepthMap(depth, normal.astype(np.float32), rng.uniform(0, 1, (9, 13)).astype(np.float32))
    write_map(tmp_path / "a.npz", found)
    back = read_map(tmp_path / "a.npz")
    np.testing.assert_array_equal(back.depth, depth)
    np.testing.assert_allclose(back.normal, normal, atol=1e-3)
    for folder in ("depth_maps", "normal_maps"):
        (tmp_path / "stereo" / folder).mkdir(parents=True)
    write_maps(tmp_path, "a.jpg", found)
    again = read_maps(tmp_path, "a.jpg")
    np.testing.assert_array_equal(again.depth, depth)
    np.testing.assert_array_equal(again.normal, found.normal)
    assert again.cost[2, 3] == 2
    (tmp_path / "broken.npz").write_bytes(b"x")
    with pytest.raises(StageFailed):
        read_map(tmp_path / "broken.npz")


def test_cuda_is_chosen_when_there_and_refused_when_demanded_in_vain() -> None:
    auto, cpu, cuda = (make_settings("default", {"dense.method": m}).dense for m in ("auto", "cpu", "cuda"))
    assert resolve_method(auto, has_cuda=False) == "cpu"
    assert resolve_method(auto, has_cuda=True) == "cuda"
    assert resolve_method(cpu, has_cuda=True) == "cpu"
    assert resolve_method(cuda, has_cuda=True) == "cuda"
    with pytest.raises(BadInput) as caught:
        resolve_method(cuda, has_cuda=False)
    assert caught.value.where == "dense.method"


def test_colmap_reads_our_options_and_configuration(undistorted: Undistorted, tmp_path: Path) -> None:
    settings = make_settings("default", {"dense.min_ncc": 0.2, "dense.min_consistent": 3}).dense
    first, second = (patch_match_options(settings, geometric=flag) for flag in (False, True))
    assert (first.geom_consistency, first.filter) == (False, False)
    assert (second.geom_consistency, second.filter, second.filter_min_num_consistent) == (True, True, 3)
    views = [replace(view, sources=("0001.jpg", "0003.jpg")) for view in open_scene(undistorted.folder).views[:1]]
    write_workspace(tmp_path, undistorted.folder, views)
    config = write_patch_match_config(tmp_path, views)
    assert config.read_text() == "0000.jpg\n0001.jpg, 0003.jpg\n"
    assert (tmp_path / "stereo" / "fusion.cfg").read_text() == "0000.jpg\n"
    assert (tmp_path / "images" / "0003.jpg").exists()
