"""A scene on disk: video, annotations, and truth in the form that `bladeatlas-bench accuracy` reads."""

from __future__ import annotations

import json
import shutil
from dataclasses import asdict
from fractions import Fraction
from pathlib import Path
from typing import Any

import av
import numpy as np
from numpy.typing import NDArray

from bench.accuracy.true_coverage import true_coverage
from bench.accuracy.truth import Truth, load_truth
from bench.scenes.blades import HEIGHT_MM, HUB_MM, Defect, Row, build_row
from bench.scenes.detector import Detector, Visible, visible_defects
from bench.scenes.path import Path as Motion
from bench.scenes.path import make_path
from bench.scenes.render import Painter, true_lens
from bench.scenes.spec import Scene
from bench.scenes.true_size import true_size
from core.surface.ply import Mesh, write_mesh

F64 = NDArray[np.float64]

TIME_BASE = Fraction(1, 12_800)
MM = 1e-3
"""Metres."""
PATCH_REACH = 1.1
"""A patch reaches this far from the nominal centre, in radii."""
MAX_PATCH_POINTS = 300


def make_scene(scene: Scene, folder: Path, motion: Motion | None = None) -> None:
    """Write ``video.mp4``, ``annotations.json``, ``truth/`` and ``scene.json``, whole or not at all.

    Args:
        scene: what to render.
        folder: of the scene; an older one is replaced.
        motion: of the camera, `n_frames` long, in place of the scene's own.
    """
    work = folder.with_name(folder.name + ".part")
    shutil.rmtree(work, ignore_errors=True)
    (work / "truth").mkdir(parents=True)
    row, path = build_row(scene), motion or make_path(scene)
    kept, times = frame_times(scene)
    seen = Seen(scene, row)
    entries: dict[str, Any] = {}
    detector = Detector(scene)
    with av.open(str(work / "video.mp4"), "w") as container:
        stream = video_stream(container, scene.fps, scene.lens.width, scene.lens.height)
        for i, frame in enumerate(Painter(scene, row, path).frames()):
            if i not in kept:
                continue
            seconds = times[kept.index(i)]
            picture = av.VideoFrame.from_ndarray(frame.rgb, format="rgb24")
            picture.pts, picture.time_base = round(seconds / TIME_BASE), TIME_BASE
            container.mux(stream.encode(picture))
            visible = seen.add(frame.defect, frame.point)
            entries[f"{seconds:.4f}"] = detector.entry(visible)
        container.mux(stream.encode(None))
    (work / "annotations.json").write_text(json.dumps(entries), encoding="utf-8")
    poses = path.rotor_from_cam()[kept]
    write_truth(scene, row, poses, times, seen, work / "truth")
    (work / "scene.json").write_text(json.dumps({"digest": scene.digest(), **asdict(scene)}, indent=1))
    shutil.rmtree(folder, ignore_errors=True)
    work.rename(folder)


def make_missing(scene: Scene, folder: Path, motion: Motion | None = None) -> None:
    """`make_scene` where the folder does not hold this very scene; the folders above are made too."""
    if not is_made(scene, folder):
        folder.parent.mkdir(parents=True, exist_ok=True)
        make_scene(scene, folder, motion)


def is_made(scene: Scene, folder: Path) -> bool:
    """Whether the folder holds this very scene."""
    try:
        return bool(json.loads((folder / "scene.json").read_text())["digest"] == scene.digest())
    except (OSError, ValueError, KeyError):
        return False


def frame_times(scene: Scene) -> tuple[list[int], list[float]]:
    """Rendered frames that the video keeps, and their presentation times, s: rising, from 0, whole ticks."""
    rng = np.random.default_rng(scene.seed + 5)
    lost = rng.random(scene.n_frames) < scene.dropped
    lost[0] = False
    kept = np.flatnonzero(~lost)
    seconds = kept / scene.fps + np.clip(rng.normal(size=len(kept)), -2, 2) * scene.jitter_s
    ticks = np.maximum.accumulate(np.round((seconds - seconds[0]) / float(TIME_BASE)).astype(np.int64))
    ticks += np.arange(len(ticks)) * (ticks[1:] == ticks[:-1]).any()  # two at one moment would be one
    return kept.tolist(), (ticks * float(TIME_BASE)).tolist()


def video_stream(container: Any, fps: float, width: int, height: int) -> Any:
    """H.264 as the clips of this bench are written; times in `TIME_BASE`."""
    stream = container.add_stream("libx264", rate=Fraction(fps).limit_denominator(1000))
    stream.width, stream.height, stream.pix_fmt = width, height, "yuv420p"
    stream.codec_context.time_base = TIME_BASE
    stream.options = {"crf": "17", "preset": "veryfast", "threads": "1"}
    return stream


class Seen:
    """What the frames show of the defects: boxes, and the true surface inside them."""

    def __init__(self, scene: Scene, row: Row) -> None:
        self._row = row
        self._kinds = {one.number: one.kind for one in row.defects}
        self._rng = np.random.default_rng(scene.seed + 6)
        self.frames: list[list[dict[str, Any]]] = []
        self.points: dict[int, list[F64]] = {one.number: [] for one in row.defects}
        self.shape: dict[int, list[F64]] = {one.number: [] for one in row.defects}

    def add(self, labels: NDArray[np.int32], point: F64) -> list[Visible]:
        """Note one frame."""
        visible = visible_defects(labels, self._kinds)
        self.frames.append([{"defect": one.number, "bbox": one.box_px.tolist()} for one in visible])
        for one in visible:
            x1, y1, x2, y2 = one.box_px.astype(int)
            inside = point[y1:y2, x1:x2].reshape(-1, 3)
            defect = self._row.defects[one.number]
            away = np.linalg.norm(inside - defect.center, axis=1)
            near = inside[np.nan_to_num(away, nan=np.inf) <= PATCH_REACH * defect.radius_mm]
            self.points[one.number].append(near[self._rng.permutation(len(near))[:200]])
            self.shape[one.number].append(point[labels == one.number])
        return visible

    def patch(self, number: int) -> F64:
        """(n, 3) points of the true surface that shows a defect, mm."""
        parts = self.points[number]
        return np.concatenate(parts) if parts else np.zeros((0, 3))


def write_truth(scene: Scene, row: Row, poses: F64, times: list[float], seen: Seen, folder: Path) -> None:
    """Write ``cameras.json``, ``defects.json`` and ``surface.ply``, metres.

    Args:
        scene: that was filmed.
        row: its blades.
        poses: (n, 4, 4) rotor_from_cam of the frames, mm.
        times: presentation times of the n frames, s.
        seen: what these frames show.
        folder: that they are written to.
    """
    lens = true_lens(scene.lens)
    in_metres = poses.copy()
    in_metres[:, :3, 3] *= MM
    cameras = {
        "units": "metre, rotor frame (engine axis = z)",
        "convention": "cam_to_world 4x4, OpenCV axes; frame i of the video",
        "camera": {"width": lens.width, "height": lens.height, "F": lens.focal_px, "K3": lens.k3},
        "roi": list(scene.roi),
        "fps": scene.fps,
        "times_s": times,
        "cam_to_world": in_metres.round(9).tolist(),
    }
    (folder / "cameras.json").write_text(json.dumps(cameras), encoding="utf-8")
    defects = {
        "blades_in_row": scene.blades_in_row,
        "hub_radius_m": HUB_MM * MM,
        "blade_height_m": HEIGHT_MM * MM,
        "chord_m": [value * MM for value in scene.chord_mm],
        "stagger_deg": list(scene.stagger_deg),
        "defects": [_defect(one, seen, scene, row) for one in row.defects],
        "visible": seen.frames,
    }
    write_mesh(folder / "surface.ply", Mesh(row.vertices * MM, row.faces), ["unit: metre"])
    (folder / "defects.json").write_text(json.dumps(defects), encoding="utf-8")
    covered = {**defects, "coverage": _coverage(load_truth(folder))}
    (folder / "defects.json").write_text(json.dumps(covered), encoding="utf-8")


def _coverage(truth: Truth) -> list[dict[str, Any]]:
    """What all frames of the clip together show of every blade."""
    shown = {} if truth.row is None else true_coverage(truth, truth.row, range(truth.n_frames))
    return [
        {"blade": blade, "share": one.share, **{f"views_{least}": part for least, part in one.by_views.items()}}
        for blade, one in shown.items()
    ]


def _defect(one: Defect, seen: Seen, scene: Scene, row: Row) -> dict[str, Any]:
    patch = seen.patch(one.number)
    chosen = np.random.default_rng(scene.seed + one.number).permutation(len(patch))[:MAX_PATCH_POINTS]
    return {
        "id": one.number,
        "blade": one.blade,
        "kind": one.kind,
        "span": one.span,
        "chord": one.chord,
        "side": one.side,
        "radius_m": one.radius_mm * MM,
        "center": (one.center * MM).tolist(),
        "surface_center": (patch.mean(axis=0) * MM).tolist() if len(patch) else None,
        "surface_points": (patch[chosen] * MM).round(7).tolist(),
        **true_size(scene, one, np.concatenate([np.zeros((0, 3)), *seen.shape[one.number]]), row),
    }
