"""Write chosen frames of a video as cropped JPEG images, in one sequential pass."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Sequence
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from core.errors import StageFailed
from core.frames.sampling import ChosenFrame
from core.scene.frame import Crop, image_name
from core.video.factory import reopen_video
from core.video.limits import MAX_FRAME_PIXELS
from core.video.shown import shown_frames
from core.video.table import FrameTable


def export_frames(
    video: Path,
    table: FrameTable,
    chosen: Sequence[ChosenFrame],
    crop: Crop,
    folder: Path,
    *,
    jpeg_quality: int,
    max_pixels: int = MAX_FRAME_PIXELS,
    on_frame: Callable[[int], None] | None = None,
) -> None:
    """Write the crop of every chosen frame of one video to `folder`.

    They are written as shown: fields joined and pixels square, else as decoded. Frames are found by counting, never by
    seeking, and each must have the hash of the frame table: a detection can then not meet another frame than the one
    it was made on.

    Args:
        video: the file that `table` was made from.
        table: its frame table.
        chosen: frames of this video to write, at most one per source frame.
        crop: the part of them.
        folder: existing folder for ``0000.jpg`` ...
        jpeg_quality: 0-100.
        max_pixels: limit on the pixels of a picture.
        on_frame: called with the number of decoded frames; may raise to stop.

    Raises:
        StageFailed: the video is not the one of the table.
    """
    by_source = {frame.source.source_index: frame.index for frame in chosen}
    left = len(by_source)
    if not left:
        return
    with reopen_video(video, table.info, max_pixels=max_pixels) as reader:
        for shown in shown_frames(reader.frames(), table.info):
            frame = shown.decoded
            index = by_source.get(frame.index)
            if index is not None:
                if hashlib.sha256(frame.rgb().data).hexdigest() != table.rows[frame.index].sha256:
                    raise StageFailed(
                        f"frame {frame.index} of '{video.name}' changed since it was probed", where="frames"
                    )
                rgb = shown.rgb()
                (folder / image_name(index)).write_bytes(_jpeg(rgb[crop.y0 : crop.y1, crop.x0 : crop.x1], jpeg_quality))
                left -= 1
            if on_frame:
                on_frame(frame.index + 1)
            if not left:
                return
    raise StageFailed(f"'{video.name}' has fewer frames than when it was probed", where="frames")


def _jpeg(rgb: NDArray[np.uint8], quality: int) -> bytes:
    """JPEG bytes; encoded in memory, because OpenCV's own file writing hides a full disk."""
    done, data = cv2.imencode(".jpg", np.ascontiguousarray(rgb[..., ::-1]), [cv2.IMWRITE_JPEG_QUALITY, quality])
    if not done:
        raise StageFailed("a frame could not be encoded as JPEG", where="frames")
    return bytes(data)
