"""One picture of the surface per defect: as the camera of its best view saw it, nearer, with the defect coloured."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from math import atan2, degrees
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from core.outputs import PORTRAITS, portrait_name
from core.render import Picture, Renderer
from core.scene.defect import DefectRecord
from core.scene.views import Views
from core.surface.ply import Mesh
from core.viewer.pictures import write_jpeg
from core.viewer.scene import best_frames
from core.viewpoint import Viewpoint

F64 = NDArray[np.float64]

WIDTH_PX, HEIGHT_PX = 480, 360
SHOWN_RADII = 5.0
"""Half the height of a picture over the radius of its defect: enough of the blade around it to know the place."""
_FOV_DEG = (3.0, 60.0)
_TINT = np.array([255.0, 120.0, 0.0])
"""Orange: bare metal has no such colour."""
_TINT_SHARE = 0.6
_OUTLINE = (255, 255, 255)


def write_portraits(
    folder: Path, mesh: Mesh, views: Views, records: Iterable[DefectRecord], threads: int = 1
) -> list[int]:
    """Write the pictures below `folder`; gives the numbers of the defects that have one.

    A defect that covers no face, or that no registered view sees, has none.

    Args:
        folder: existing.
        mesh: supported surface, its front towards the cameras.
        views: registered views of the model.
        records: defects of the model; their faces are of `mesh`.
        threads: side by side.
    """
    shown = [(record, at) for record in records if len(record.faces) and (at := _best(record, views)) is not None]
    if not shown:
        return []
    (folder / PORTRAITS).mkdir()
    renderer = Renderer(_tinted(mesh, [record for record, _ in shown]), threads)
    for record, at in shown:
        corners = mesh.vertices[np.unique(mesh.faces[np.asarray(record.faces, np.int64)])]
        view = _viewpoint(views.R[at], views.centers[at], corners)
        picture = renderer.render(view, WIDTH_PX, HEIGHT_PX)
        write_jpeg(folder / PORTRAITS / portrait_name(record.id), _outlined(picture, record.id))
    return [record.id for record, _ in shown]


def _best(record: DefectRecord, views: Views) -> int | None:
    """Row among the views of the first of its best frames that is registered."""
    return next((at for index in best_frames(record) if (at := views.row(index)) is not None), None)


def _outlined(picture: Picture, number: int) -> NDArray[np.uint8]:
    """(h, w, 3) the picture with a line around its own defect: others that are in sight have the same colour."""
    own = (picture.defect == number).astype(np.uint8)
    lines, _ = cv2.findContours(own, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    drawn = np.ascontiguousarray(picture.rgb)
    cv2.drawContours(drawn, lines, -1, _OUTLINE, 2, cv2.LINE_AA)
    return drawn


def _tinted(mesh: Mesh, records: Sequence[DefectRecord]) -> Mesh:
    """The mesh with the numbers of the defects, and their colour over what the frames show of them."""
    colors = np.full((len(mesh.vertices), 3), 180, np.uint8) if mesh.colors is None else mesh.colors.copy()
    faces = np.concatenate([np.asarray(record.faces, np.int64) for record in records])
    marked = np.unique(mesh.faces[faces])
    number = np.full(len(mesh.vertices), -1, np.int32)
    for record in records:
        number[np.unique(mesh.faces[np.asarray(record.faces, np.int64)])] = record.id
    colors[marked] = np.rint((1 - _TINT_SHARE) * colors[marked] + _TINT_SHARE * _TINT).astype(np.uint8)
    return replace(mesh, colors=colors, extra={**mesh.extra, "defect_id": number})


def _viewpoint(rotation: F64, center: F64, corners: F64) -> Viewpoint:
    """From the camera's place towards the middle of the defect, up as in the camera's picture.

    Args:
        rotation: (3, 3) cam_from_world of the view.
        center: (3,) the camera's place.
        corners: (n, 3) vertices of the defect.
    """
    middle = (corners.min(axis=0) + corners.max(axis=0)) / 2
    radius = float(np.linalg.norm(corners - middle, axis=1).max())
    distance = float(np.linalg.norm(middle - center))
    forward = (middle - center) / distance
    right = rotation[0] - (rotation[0] @ forward) * forward
    right /= np.linalg.norm(right)
    fov = float(np.clip(2 * degrees(atan2(SHOWN_RADII * radius, distance)), *_FOV_DEG))
    return Viewpoint(center, right, np.cross(forward, right), forward, fov)
