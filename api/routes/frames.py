"""Frames that the reconstruction saw, with the detections on them."""

from __future__ import annotations

import io
import json
from collections.abc import Mapping, Sequence
from typing import Annotated, Any

from fastapi import APIRouter, Query, Request, Response
from PIL import Image, ImageDraw

from api.auth import LinkReader
from api.finding import find_inspection
from api.problems import not_found, responses
from api.services import Services
from api.state import state_of
from core.gallery.palette import RGB, label_colors
from core.scene.detection import Outcome
from store.tables import DETECTIONS, RowFilter, labels, read_rows

router = APIRouter(prefix="/v1/inspections/{inspection_id}", tags=["results"])

_LARGEST_INDEX = 2**31
_JPEG_QUALITY = 90


@router.get(
    "/frames/{index}.jpg",
    summary="A reconstruction frame",
    response_class=Response,
    responses={
        200: {"content": {"image/jpeg": {"schema": {"type": "string", "format": "binary"}}}},
        **responses(401, 404, 410, 422, 503),
    },
)
def frame(
    request: Request,
    caller: LinkReader,
    inspection_id: str,
    index: str,
    boxes: Annotated[bool, Query(description="draw the detections on it: solid = mapped")] = False,
) -> Response:
    """The frame as it was cropped for the reconstruction; `index` is that of frames.csv."""
    services = state_of(request).services
    find_inspection(services, inspection_id, caller.owner)
    number = int(index) if index.isascii() and index.isdigit() and len(index) < 11 else -1
    folder = _folder(services, inspection_id)
    if not 0 <= number < _LARGEST_INDEX or folder is None:
        raise not_found("frame")
    try:
        with services.results.open(f"{folder}/images/{number:04d}.jpg") as stream:
            picture = stream.read()
        if boxes:
            with services.results.open(f"{folder}/crop.json") as stream:
                crop = json.load(stream)
            # Colours are those of all labels, so that they are the same on every frame and in the gallery.
            rows = read_rows(services.db, inspection_id, DETECTIONS, RowFilter({"frame_index": number}))
            picture = draw(picture, crop, rows, label_colors(labels(services.db, inspection_id)))
    except FileNotFoundError:
        raise not_found("frame") from None
    return Response(picture, media_type="image/jpeg")


def _folder(services: Services, inspection_id: str) -> str | None:
    """Where the result of the stage `frames` lies; None while there is none."""
    tasks = services.inspections.tasks(inspection_id)
    return next((task.path for task in tasks if task.key == "frames"), None)


def draw(jpeg: bytes, crop: Mapping[str, int], rows: Sequence[Mapping[str, Any]], colors: Mapping[str, RGB]) -> bytes:
    """The frame with boxes, solid where the detection is mapped and thin where it is not.

    Args:
        crop: the region of the source frame that `jpeg` shows, in source pixels (`crop.json`).
        rows: detections; their boxes are shares of the source frame.
    """
    with Image.open(io.BytesIO(jpeg)) as opened:
        picture = opened.convert("RGB")
    pen = ImageDraw.Draw(picture)
    thick = max(2, picture.width // 300)
    for row in rows:
        left = row["box_x1"] * crop["source_width"] - crop["x0"]
        top = row["box_y1"] * crop["source_height"] - crop["y0"]
        right = row["box_x2"] * crop["source_width"] - crop["x0"]
        bottom = row["box_y2"] * crop["source_height"] - crop["y0"]
        color = colors[row["label"]]
        pen.rectangle((left, top, right, bottom), outline=color, width=thick if row["outcome"] == Outcome.MAPPED else 1)
        pen.text((left + thick + 1, top + thick), _tag(row), fill=color)
    out = io.BytesIO()
    picture.save(out, "JPEG", quality=_JPEG_QUALITY)
    return out.getvalue()


def _tag(row: Mapping[str, Any]) -> str:
    """Label and score in the characters that the built-in font has."""
    score = f" {row['score']:.2f}" if row["score"] is not None else ""
    return f"{row['label']}{score}".encode("latin-1", "replace").decode("latin-1")
