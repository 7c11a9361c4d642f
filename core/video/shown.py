"""From decoded pictures to those that are worked on and shown: whole ones instead of two fields, with square pixels."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

import av
import numpy as np
from av.filter import Graph
from numpy.typing import NDArray

from core.video.decode import DecodedFrame
from core.video.orientation import square_width
from core.video.table import VideoInfo

_DEINTERLACER = "mode=send_frame:parity=auto:deint=interlaced"
"""One picture per frame, field order from the frames; frames that are not interlaced pass unchanged."""


@dataclass(frozen=True)
class ShownFrame:
    """A frame as it is shown, beside the one that was decoded."""

    decoded: DecodedFrame
    _picture: Any = field(repr=False)
    _aspect: Fraction = field(repr=False)

    def rgb(self) -> NDArray[np.uint8]:
        """(h, w, 3) uint8 RGB with square pixels, turned as the rotation flag asks."""
        if self._aspect == 1:
            return self.decoded.orientation.apply(self._picture.to_ndarray(format="rgb24"))
        width = square_width(self._picture.width, self._aspect)
        square = self._picture.reformat(
            width=width, height=self._picture.height, format="rgb24", interpolation="BICUBIC"
        )
        return self.decoded.orientation.apply(square.to_ndarray())


def shown_frames(frames: Iterable[DecodedFrame], info: VideoInfo) -> Iterator[ShownFrame]:
    """The frames of a probed video as they are shown, one for each that was decoded, in the same order.

    Args:
        frames: all decoded frames from the first on: a deinterlacer needs the neighbours of each.
        info: what probing found; a video without interlaced frames is handed on bit for bit.
    """
    aspect = info.sample_aspect_ratio
    if not info.interlaced_frames:
        for frame in frames:
            yield ShownFrame(frame, frame.coded, aspect)
        return
    waiting: deque[DecodedFrame] = deque()
    graph: Graph | None = None
    for frame in frames:
        graph = graph or _deinterlacer(frame.coded, info)
        waiting.append(frame)
        graph.vpush(frame.coded)
        for picture in _ready(graph):
            yield ShownFrame(waiting.popleft(), picture, aspect)
    if graph is not None:
        graph.vpush(None)
        for picture in _ready(graph):
            yield ShownFrame(waiting.popleft(), picture, aspect)


def _deinterlacer(picture: Any, info: VideoInfo) -> Graph:
    """FFmpeg's bwdif for pictures of this size and form."""
    graph = Graph()
    graph.threads = 1
    steps = [
        graph.add_buffer(width=picture.width, height=picture.height, format=picture.format, time_base=picture.time_base)
    ]
    if info.field_order:
        steps.append(graph.add("setfield", info.field_order))
    steps += [graph.add("bwdif", _DEINTERLACER), graph.add("buffersink")]
    graph.link_nodes(*steps).configure()
    return graph


def _ready(graph: Graph) -> Iterator[Any]:
    """Pictures that the graph has finished."""
    while True:
        try:
            yield graph.vpull()
        except (av.error.BlockingIOError, av.error.EOFError):
            return
