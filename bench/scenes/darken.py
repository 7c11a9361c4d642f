"""`bladeatlas-bench darken`: a cut of a video with truth whose lights go out for some frames."""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterator
from pathlib import Path

import av
import numpy as np
from numpy.typing import NDArray

from core.errors import BadInput

GAMMA = 2.2
"""Of the coded values: light is their power."""
NOISE = 0.008
"""Standard deviation of the sensor's noise, as a share of the largest coded value; that of the rendered scenes."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the command's arguments."""
    parser.add_argument("folder", type=Path, metavar="FOLDER", help="of video.mp4, annotations.json and truth/")
    parser.add_argument("out", type=Path, metavar="OUT", help="folder for the same of the cut")
    parser.add_argument("--start", type=int, default=0, help="first frame of the cut (0)")
    parser.add_argument("--frames", type=int, required=True, help="frames of the cut")
    parser.add_argument("--dark", type=int, required=True, help="frames without light, in the middle of the cut")
    parser.add_argument("--light", type=float, required=True, help="share of the light that is left, 0 to 1")
    parser.add_argument("--seed", type=int, default=0, help="of the noise (0)")


def command(arguments: argparse.Namespace) -> None:
    """Write the cut's video, annotations and truth; the true defects are those of the whole video."""
    truth = json.loads((arguments.folder / "truth" / "cameras.json").read_text(encoding="utf-8"))
    start, end = arguments.start, arguments.start + arguments.frames
    if not 0 <= start < end <= len(truth["cam_to_world"]) or arguments.dark > arguments.frames:
        raise BadInput(f"frames {start} to {end} are not in the video, or fewer than the dark ones", where="--frames")
    (arguments.out / "truth").mkdir(parents=True, exist_ok=True)
    first = start + (arguments.frames - arguments.dark) // 2
    dark = range(first, first + arguments.dark)
    _write_video(arguments, float(truth["fps"]), start, end, dark)
    truth["cam_to_world"] = truth["cam_to_world"][start:end]
    (arguments.out / "truth" / "cameras.json").write_text(json.dumps(truth), encoding="utf-8")
    defects = json.loads((arguments.folder / "truth" / "defects.json").read_text(encoding="utf-8"))
    defects["visible"] = defects["visible"][start:end]
    (arguments.out / "truth" / "defects.json").write_text(json.dumps(defects), encoding="utf-8")
    surface = (arguments.folder / "truth" / "surface.ply").read_bytes()
    (arguments.out / "truth" / "surface.ply").write_bytes(surface)
    entries = json.loads((arguments.folder / "annotations.json").read_text(encoding="utf-8"))
    kept = {}
    for key, entry in entries.items():
        frame = round(float(key) * truth["fps"])
        if start <= frame < end and frame not in dark:  # nobody detects anything in the dark
            kept[f"{(frame - start) / truth['fps']:.4f}"] = entry
    (arguments.out / "annotations.json").write_text(json.dumps(kept), encoding="utf-8")


def _write_video(arguments: argparse.Namespace, fps: float, start: int, end: int, dark: range) -> None:
    rng = np.random.default_rng(arguments.seed)
    with av.open(str(arguments.out / "video.mp4"), "w") as container:
        stream = None
        for index, rgb in enumerate(_frames(arguments.folder / "video.mp4", end)):
            if index < start:
                continue
            if stream is None:
                stream = container.add_stream("libx264", rate=round(fps))
                stream.height, stream.width, stream.pix_fmt = *rgb.shape[:2], "yuv420p"
                stream.options = {"crf": "17", "preset": "veryfast", "threads": "1"}
            shown = darkened(rgb, arguments.light, rng) if index in dark else rgb
            container.mux(stream.encode(av.VideoFrame.from_ndarray(shown, format="rgb24")))
        if stream is not None:
            container.mux(stream.encode(None))


def _frames(path: Path, end: int) -> Iterator[NDArray[np.uint8]]:
    with av.open(str(path)) as container:
        for index, frame in enumerate(container.decode(video=0)):
            if index == end:
                return
            yield np.asarray(frame.to_ndarray(format="rgb24"), np.uint8)


def darkened(rgb: NDArray[np.uint8], light: float, rng: np.random.Generator) -> NDArray[np.uint8]:
    """What a camera without automatic gain shows of a picture (h, w, 3) at a share of its light, with its noise."""
    coded = rgb.astype(np.float64) / 255.0 * light ** (1.0 / GAMMA)
    noisy = coded + rng.normal(0.0, NOISE, rgb.shape)
    return np.asarray(np.clip(np.round(255.0 * noisy), 0, 255), np.uint8)
