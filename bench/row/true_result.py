"""A result that saw right: the true surface as far as frames show it, the true cameras, findings at their true places.

What a row is found from, without a video being reconstructed; a wrongly welded model is made from it.
"""

from __future__ import annotations

import json
import shutil
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import cv2  # noqa: F401  (before pycolmap: the other order aborts when a PNG is written)
import numpy as np
import pycolmap
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from bench.accuracy.true_coverage import GRAZING_COSINE
from bench.accuracy.truth import Lens
from bench.row.cases import Case
from bench.scenes.blades import Row, build_row
from bench.scenes.detector import Visible
from bench.scenes.make import Seen, frame_times, write_truth
from bench.scenes.path import make_path
from bench.scenes.render import Painter, true_lens
from core.flags import Flag, Severity, between_frames, verdict_by
from core.geometry.pose import transform
from core.outputs import DEFECT_SURFACE, DEFECTS, DETECTIONS, FRAMES, QUALITY, SPARSE, SUMMARY, SURFACE
from core.report.tables import write_csv
from core.scene.defect import MODEL_UNIT, DefectRecord, Extent, Persistence
from core.scene.detection import DETECTION_COLUMNS, Detection, DetectionRow, mapped_row
from core.surface.ply import Mesh, write_mesh

F64 = NDArray[np.float64]
Flags = NDArray[np.bool_]

EVERY = 2
"""Of the frames that are registered; the others are left to the clip, as a run leaves them."""
MM_PER_UNIT = 37.0
"""A model has a unit and a place of its own."""
TURNED = Rotation.from_rotvec([0.7, -1.1, 0.4])
SHIFT = np.array([0.3, -2.0, 1.1])
SAME_MM = 0.6
"""A face is seen by a frame when the pixel that it falls on shows a point so near."""
LEAST_FRAMES = 2
FISHEYE_TERMS = 4


@dataclass(frozen=True)
class _Finding:
    frame: int
    seen: Visible
    place: F64
    """(3,) mm, in the rotor's frame, or where a wrong weld puts it."""


def make_true_result(case: Case, truth_folder: Path, folder: Path) -> None:
    """Write the truth of a case, without pictures, and the published files of a result that saw right."""
    scene = case.scene
    row, path = build_row(scene), make_path(scene)
    kept, times = frame_times(scene)
    poses = path.rotor_from_cam()[kept]
    painter, seen, lens = Painter(scene, row, path), Seen(scene, row), true_lens(scene.lens)
    corners = row.vertices[row.faces]
    middles, normals = corners.mean(axis=1), np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
    taken = range(0, len(kept), EVERY)
    counts = np.zeros((2, len(middles)), np.int64)
    findings = []
    for k, frame in enumerate(kept):
        point, labels = painter.sketch(frame)
        visible = seen.add(labels, point)
        if k in taken:
            half = int(k >= len(kept) // 2)
            counts[half] += _shown(middles, normals, point, poses[k], lens)
            findings += [_Finding(k, one, _place(one, labels, point)) for one in visible]
    for place in (truth_folder, folder):
        shutil.rmtree(place, ignore_errors=True)
        place.mkdir(parents=True)
    write_truth(scene, row, poses, times, seen, truth_folder)
    mesh = _cropped(row, counts.sum(axis=0) >= LEAST_FRAMES)
    if case.weld is not None:
        rotation, shift = case.weld.motion(scene)
        first, second = (_cropped(row, counts[half] >= LEAST_FRAMES) for half in (0, 1))
        mesh = _joined(first, Mesh(transform(second.vertices, rotation, shift), second.faces))
        poses = poses.copy()
        for k in range(len(kept) // 2, len(kept)):
            poses[k, :3, :3], poses[k, :3, 3] = rotation @ poses[k, :3, :3], rotation @ poses[k, :3, 3] + shift
        findings = [
            one if one.frame < len(kept) // 2 else _Finding(one.frame, one.seen, rotation @ one.place + shift)
            for one in findings
        ]
    _write(folder, mesh, poses, list(taken), times, lens, findings)
    _write_quality(folder, [] if scene.jump_at is None else [sum(kept[k] < scene.jump_at for k in taken)])


def _shown(middles: F64, normals: F64, point: F64, pose: F64, lens: Lens) -> Flags:
    """(m,) whether a frame shows the middles of faces, at most 80 degrees aslant: what hides them is nearer."""
    xy = lens.project((middles - pose[:3, 3]) @ pose[:3, :3])
    way = pose[:3, 3] - middles
    aslant = np.abs((way * normals).sum(axis=1)) <= GRAZING_COSINE * np.linalg.norm(way, axis=1)
    inside = np.flatnonzero(((xy >= 0) & (xy < (lens.width, lens.height))).all(axis=1) & ~aslant)
    column, line = xy[inside].astype(np.int64).T
    shown = np.zeros(len(middles), bool)
    # A pixel that shows nothing holds no number, and is near to nothing.
    shown[inside] = np.linalg.norm(point[line, column] - middles[inside], axis=1) < SAME_MM
    return shown


def _place(one: Visible, labels: NDArray[np.int32], point: F64) -> F64:
    """Of the pixels of a defect the one whose point is nearest to the middle of all: a place on the surface."""
    points = point[labels == one.number]
    nearest: F64 = points[int(np.linalg.norm(points - np.median(points, axis=0), axis=1).argmin())]
    return nearest


def _cropped(row: Row, shown: Flags) -> Mesh:
    faces = row.faces[shown]
    used, index = np.unique(faces, return_inverse=True)
    return Mesh(row.vertices[used], index.reshape(-1, 3).astype(np.int32))


def _joined(first: Mesh, second: Mesh) -> Mesh:
    faces = np.concatenate([first.faces, second.faces + len(first.vertices)]).astype(np.int32)
    return Mesh(np.concatenate([first.vertices, second.vertices]), faces)


def _model(points_mm: F64) -> F64:
    """(n, 3) places in the frame and unit of the model."""
    placed: F64 = TURNED.apply(points_mm / MM_PER_UNIT) + SHIFT
    return placed


def _write(
    folder: Path,
    mesh: Mesh,
    poses: F64,
    taken: list[int],
    times: list[float],
    lens: Lens,
    findings: list[_Finding],
) -> None:
    for name in (SPARSE, SURFACE, DETECTIONS):
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
    lines = [f"{i},{source},{source},{times[source]},,both,1,0" for i, source in enumerate(taken)]
    (folder / FRAMES).write_text("\n".join(["index,source_index,pts,time_s,sha256,role,registered,model", *lines]))
    (folder / SPARSE).mkdir()
    _sparse(poses[taken], lens).write_binary(folder / SPARSE)
    surface = Mesh(_model(mesh.vertices), mesh.faces)
    write_mesh(folder / SURFACE, surface)
    write_mesh(folder / DEFECT_SURFACE, surface)
    rows = [_row(k, one, taken.index(one.frame), times[one.frame], lens) for k, one in enumerate(findings)]
    tables = [row.to_dict() for row in rows]
    (folder / DETECTIONS).write_text(json.dumps(tables), encoding="utf-8")
    write_csv((folder / DETECTIONS).with_suffix(".csv"), DETECTION_COLUMNS, tables)
    (folder / DEFECTS).write_text(json.dumps([one.to_dict() for one in _records(rows, findings)]), encoding="utf-8")
    (folder / SUMMARY).write_text("{}", encoding="utf-8")


def _write_quality(folder: Path, after: Sequence[int]) -> None:
    """The verdict of a run that saw the pictures jump before these frames of its own."""
    jumps = [Flag("picture_jumps", Severity.WARNING, where=between_frames(k - 1, k)) for k in after]
    document = {"verdict": verdict_by(jumps), "flags": [flag.explained() for flag in jumps]}
    (folder / QUALITY).write_text(json.dumps(document), encoding="utf-8")


def _sparse(poses: F64, lens: Lens) -> pycolmap.Reconstruction:
    """The cameras, with OpenCV's fisheye fitted to the true lens: theta_d = theta (1 + k1 theta^2 + ...)."""
    radii = np.linspace(0.0, np.hypot(lens.width, lens.height) / 2, 200)[1:]
    theta = radii / lens.focal_px + lens.k3 * radii**3
    terms = np.stack([theta ** (2 * k + 3) for k in range(FISHEYE_TERMS)], axis=1)
    bend = np.linalg.lstsq(terms, radii / lens.focal_px - theta, rcond=None)[0]
    model = pycolmap.Reconstruction()
    focal, x, y = lens.focal_px, lens.width / 2, lens.height / 2
    params = [focal, focal, x, y, *bend]
    camera = pycolmap.Camera(model="OPENCV_FISHEYE", width=lens.width, height=lens.height, params=params, camera_id=1)
    model.add_camera_with_trivial_rig(camera)
    for i, pose in enumerate(poses):
        rotation = (TURNED * Rotation.from_matrix(pose[:3, :3])).as_matrix()
        world_from_cam = pycolmap.Rigid3d(pycolmap.Rotation3d(rotation), _model(pose[None, :3, 3])[0])
        image = pycolmap.Image(name=f"{i:04d}.jpg", points2D=[], camera_id=1, image_id=i + 1)
        model.add_image_with_trivial_frame(image, world_from_cam.inverse())
        model.register_frame(model.image(i + 1).frame_id)
    return model


def _row(number: int, one: _Finding, index: int, time_s: float, lens: Lens) -> DetectionRow:
    x0, y0, x1, y1 = one.seen.box_px / [lens.width, lens.height, lens.width, lens.height]
    box = (float(x0), float(y0), float(x1), float(y1))
    detection = Detection(number, f"{time_s:.4f}", time_s, one.seen.kind, 0.9, box, source_index=one.frame)
    return mapped_row(detection, index, _model(one.place[None])[0].tolist(), 12)


def _records(rows: list[DetectionRow], findings: list[_Finding]) -> list[DefectRecord]:
    """One defect for each that is seen, where its first detection is."""
    records = []
    for number in sorted({one.seen.number for one in findings}):
        own = [row for row, one in zip(rows, findings, strict=True) if one.seen.number == number]
        x, y, z = own[0].x or 0.0, own[0].y or 0.0, own[0].z or 0.0
        records.append(
            DefectRecord(
                id=number,
                label=own[0].label,
                labels={own[0].label: len(own)},
                model=0,
                centroid=(x, y, z),
                extent=Extent(0.0, MODEL_UNIT, 0.0),
                confidence=None,
                persistence=Persistence(len(own), len(own)),
                events=(),
                detections=tuple(row.id for row in own),
                frames=(),
                faces=(),
            )
        )
    return records
