"""What can be known to be wrong within seconds, before anything is computed."""

from __future__ import annotations

from itertools import islice
from pathlib import Path

from core.annotations.parse import load_annotations
from core.errors import BadInput
from core.settings import Settings
from core.video.decode import VideoReader


def check_input(video: Path, annotations: Path | None, settings: Settings) -> None:
    """Refuse input that no run can use; `BadInput` names what is wrong and where.

    The first two frames are decoded, the annotations are read in full. What only a full pass can find
    (damage further on, an interval outside the video) the stages say.
    """
    check_video(video)
    if annotations is not None:
        load_annotations(annotations)
    check_roi(settings)


def check_video(video: Path) -> None:
    """`BadInput` unless the file is a video whose first frames decode."""
    with VideoReader(video) as reader:
        found = sum(1 for _ in islice(reader.frames(), 2))
    if found == 0:
        raise BadInput(f"the video '{video.name}' holds no frame that decodes", code="no_frames", where="video")


def check_roi(settings: Settings) -> None:
    """`BadInput` for a region of interest that holds nothing."""
    roi = settings.roi
    if not (roi.x0 < roi.x1 and roi.y0 < roi.y1):
        raise BadInput(
            f"the region of interest {roi.x0},{roi.y0},{roi.x1},{roi.y1} is empty", code="empty_roi", where="roi"
        )
