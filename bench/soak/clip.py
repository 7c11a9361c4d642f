"""A shorter and smaller clip, so that many jobs fit into a soak."""

from __future__ import annotations

import json
from pathlib import Path

import av


def cut(video: Path, annotations: Path, folder: Path, frames: int, width: int) -> tuple[Path, Path]:
    """The first `frames` frames, `width` px wide, and the annotations that lie before their end; paths in `folder`."""
    folder.mkdir(parents=True, exist_ok=True)
    end_s = _cut_video(video, folder / "clip.mp4", frames, width)
    found = json.loads(annotations.read_text(encoding="utf-8"))
    kept = {key: value for key, value in found.items() if float(key) < end_s}
    (folder / "clip.json").write_text(json.dumps(kept), encoding="utf-8")
    return folder / "clip.mp4", folder / "clip.json"


def _cut_video(video: Path, out: Path, frames: int, width: int) -> float:
    with av.open(str(video)) as source, av.open(str(out), "w") as target:
        rate = source.streams.video[0].average_rate
        shown = source.streams.video[0]
        height = round(shown.height * width / shown.width / 2) * 2
        stream = target.add_stream("libx264", rate=rate, options={"crf": "14", "threads": "1"})
        stream.width, stream.height, stream.pix_fmt = width, height, "yuv420p"
        for frame, _ in zip(source.decode(shown), range(frames), strict=False):
            small = frame.reformat(width, height, "yuv420p").to_ndarray()
            target.mux(stream.encode(av.VideoFrame.from_ndarray(small, format="yuv420p")))
        target.mux(stream.encode())
    return (frames - 0.5) / float(rate or 1)
