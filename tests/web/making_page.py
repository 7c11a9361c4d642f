"""A small finished result with its page: two plates seen by a fisheye, two findings, and detections without a place.

The tables are those of a real run in form; the pictures are the plates as the lens shows them.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

from core.flags import Verdict
from core.mapping.surface import Surface
from core.report.build import Report
from core.scene.defect import Confidence, DefectRecord, EventRow, Extent, Persistence, Sighting
from core.scene.detection import DetectionRow, Reason, mapped_row, unplaced_row
from core.surface.ply import Mesh, write_mesh
from core.viewer.build import write_scene
from core.viewer.deliver import write_page
from core.viewer.document import ViewerSource
from core.viewer.pictures import U8, write_pictures
from core.viewer.scene import DrawnDetection, Pictures, ViewerScene
from tests.core import making_plates as plates
from tests.core.making_plates import CROP, FAR, NEAR

FRAMES = [0, 1, 2, 5, 9]
"""Registered ones of twelve."""
N_FRAMES = 12
NEAR_PLACE, FAR_PLACE = (-0.8, 0.2, NEAR), (0.9, -0.4, FAR)
NEAR_FINDING, FAR_FINDING = 3, 4
HOSTILE = "<img src=x onerror=\"document.title='ran'\"><script>document.title='ran'</script>"


def write_result(folder: Path) -> Path:
    """A result that `core.query` opens, with the page of its one model; gives the page."""
    mesh = mesh_of_plates()
    (folder / "frames.csv").write_text(
        "\n".join(["index,source_index,time_s", *(f"{i},{10 * i},{0.5 * i}" for i in range(N_FRAMES))]) + "\n"
    )
    (folder / "summary.json").write_text(json.dumps(_summary()))
    plates.write_model(folder / "sparse", FRAMES)
    (folder / "mapping").mkdir()
    write_mesh(folder / "mapping" / "mesh_defects.ply", mesh)
    page = folder / "viewer"
    page.mkdir()
    records = records_of(mesh)
    scene = write_scene(page, mesh, plates.views(FRAMES), CROP, records)
    pictures = _pictures(page, mesh)
    rows = _rows()
    events = [
        EventRow(0, NEAR_FINDING, "dent", 0.0, 1.0, 3, 3, *NEAR_PLACE, 0.1, 0.9).to_dict(),
        EventRow(1, FAR_FINDING, HOSTILE, 2.5, 4.5, 2, 2, *FAR_PLACE, 0.1, 0.3).to_dict(),
    ]
    report = Report(
        Verdict.SUSPECT,
        _summary(),
        {"verdict": "suspect", "flags": [_flag("coverage_low", "warning")]},
        _frames(FRAMES),
        (),
        [row.to_dict() for row in rows],
        events,
        [record.to_dict() for record in records],
    )
    return _write(page, report, scene, pictures)


def write_refused(folder: Path) -> Path:
    """The page of a run whose model was refused: pictures and detections, no place of anything."""
    page = folder / "viewer"
    page.mkdir()
    pictures = _pictures(page, mesh_of_plates())
    rows = [unplaced_row(plates.detection(0, NEAR_PLACE, 0), Reason.FRAME_NOT_REGISTERED, 0)]
    quality = {"verdict": "refused", "flags": [_flag("bent_model", "error")]}
    summary = {**_summary(), "state": "failed", "message": "every model was refused: bent_model"}
    report = Report(Verdict.REFUSED, summary, quality, _frames([]), (), [row.to_dict() for row in rows], [], [])
    return _write(page, report, None, pictures)


def _write(page: Path, report: Report, scene: ViewerScene | None, pictures: Pictures) -> Path:
    write_page(page, ViewerSource(report, scene, pictures), None if scene is None else page / "surface.glb")
    return page / "index.html"


def _summary() -> dict[str, object]:
    crop = [CROP.x0, CROP.y0, CROP.x1, CROP.y1]
    frame = {"width": CROP.source_width, "height": CROP.source_height, "crop": crop, "n_frames": 120, "duration_s": 6.0}
    return {"frame": frame, "state": "succeeded", "label": f"Row 1 {HOSTILE}"}


def _flag(code: str, severity: str) -> dict[str, str]:
    return {"code": code, "severity": severity, "meaning": f"what {code} means", "where": ""}


def _frames(registered: list[int]) -> list[dict[str, str | int | float | None]]:
    return [
        {"index": i, "video": 0, "source_index": 10 * i, "time_s": 0.5 * i, "model": 0 if i in registered else None}
        for i in range(N_FRAMES)
    ]


def mesh_of_plates() -> Mesh:
    mesh = plates.plates()
    defect = np.full(len(mesh.vertices), -1, np.int32)
    for number, place in ((NEAR_FINDING, NEAR_PLACE), (FAR_FINDING, FAR_PLACE)):
        defect[np.linalg.norm(mesh.vertices - place, axis=1) < 0.25] = number
    x, y, z = mesh.vertices.T
    tile = (np.floor(2 * x) + np.floor(2 * y)) % 2
    grey = np.where(z < 5, 150 + 60 * tile, 60 + 50 * tile)
    support = np.where(x > 3, 0.1, np.where(x > 2.4, 0.4, 1.0)).astype(np.float32)
    colors = np.repeat(grey[:, None], 3, axis=1).astype(np.uint8)
    blade = np.where(z < 5, 1, 2).astype(np.int32)  # the plates stand for two blades: each is a node of the GLB
    return Mesh(mesh.vertices, mesh.faces, colors, extra={"defect_id": defect, "support": support, "blade": blade})


def records_of(mesh: Mesh) -> list[DefectRecord]:
    parts = {"views_visible": 4.0, "views_support": 2.0, "views_same_label": 1.0, "peers": 2.0, "cosine": 0.9}

    def record(number: int, label: str, place: tuple[float, float, float], value: float, size: float) -> DefectRecord:
        faces = np.flatnonzero((mesh.extra["defect_id"][mesh.faces] == number).all(axis=1))
        detected = [0, 1, 2] if number == NEAR_FINDING else [5, 9]
        rest = [frame for frame in FRAMES if frame not in detected]
        seen = tuple(Sighting(frame, 1 - 0.05 * k, None, frame in detected) for k, frame in enumerate(detected + rest))
        return DefectRecord(
            number,
            label,
            {label: 3},
            0,
            place,
            Extent(size, "model", 0.04),
            Confidence(value, dict(parts)),
            Persistence(len(detected), 5),
            (0 if number == NEAR_FINDING else 1,),
            tuple(range(3)) if number == NEAR_FINDING else (3, 4),
            seen,
            tuple(faces.tolist()),
            centroid_sigma=0.01,
            normal=(0.0, 0.0, -1.0),
        )

    return [
        record(NEAR_FINDING, "dent", NEAR_PLACE, 0.9, 0.5),
        record(FAR_FINDING, HOSTILE, FAR_PLACE, 0.3, 0.7),
    ]


def _rows() -> list[DetectionRow]:
    on_near = [(number, frame) for number, frame in enumerate((0, 1, 2))]
    rows = [_on(number, frame, NEAR_PLACE, NEAR_FINDING, "dent") for number, frame in on_near]
    rows += [_on(number, frame, FAR_PLACE, FAR_FINDING, HOSTILE) for number, frame in ((3, 5), (4, 9))]
    lost = plates.detection(5, NEAR_PLACE, 3, label="nick")
    return [*rows, unplaced_row(lost, Reason.FRAME_NOT_REGISTERED, 3)]


def _on(number: int, frame: int, place: tuple[float, float, float], finding: int, label: str) -> DetectionRow:
    row = mapped_row(plates.detection(number, place, frame, label=label), frame, place, 5)
    return replace(row, defect_id=finding, confidence=0.8)


def _pictures(page: Path, mesh: Mesh) -> Pictures:
    shown = {number: DrawnDetection(frame, None) for number, frame in ((0, 0), (1, 1), (2, 2), (3, 5), (4, 9), (5, 3))}
    made = write_pictures(page, _drawn(mesh), shown)
    (page / "pictures.json").unlink()
    return made


def _drawn(mesh: Mesh) -> Iterator[tuple[int, U8]]:
    """The plates through the lens, in their own colours; black outside the part that is used."""
    surface = Surface(mesh.vertices, mesh.faces)
    views = plates.views(list(range(N_FRAMES)))
    columns, rows = np.meshgrid(np.arange(plates.WIDTH) + 0.5, np.arange(plates.HEIGHT) + 0.5)
    xy = np.column_stack([columns.ravel(), rows.ravel()])
    assert mesh.colors is not None
    for index in range(N_FRAMES):
        rays = views.rays(xy, views.R[index])
        hits = surface.cast(np.broadcast_to(views.centers[index], rays.shape), rays)
        part = np.where(hits.hit[:, None], mesh.colors[mesh.faces[hits.face, 0]], 0)
        picture = np.zeros((CROP.source_height, CROP.source_width, 3), np.uint8)
        picture[CROP.y0 : CROP.y1, CROP.x0 : CROP.x1] = part.reshape(plates.HEIGHT, plates.WIDTH, 3)
        yield index, picture
