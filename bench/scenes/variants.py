"""Clips made from a clip with truth: fewer of its frames, or some of them with hardly any light.

What is asked of them: the same motion read at another rate gives the same answer, and a short dark stretch does not
take a clip apart.
"""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

import av
import numpy as np
from numpy.typing import NDArray

from bench.accuracy.result import read_sparse
from bench.accuracy.truth import Truth, load_truth
from bench.kept import Found, kept_or_new
from bench.scenes.make import TIME_BASE, make_missing, video_stream
from bench.scenes.path import make_path, resampled
from bench.scenes.render import TONE
from bench.scenes.run import DEFAULT, program_digest, run_and_score
from bench.scenes.spec import Lens, Scene
from core.errors import BadInput
from core.video.decode import iter_frames

U8 = NDArray[np.uint8]

SLOW = Scene("slow", 41, Lens(480, 360, 92.0), n_frames=96)
"""8 s of motion at 12 frames a second, whose path is told at 60."""
FAST_FPS = 60
STEPS = (1, 4, 12)
NOISE = 0.008
"""Standard deviation of the sensor's noise, share of the full scale."""


def rewrite(
    source: Path,
    folder: Path,
    frames: Sequence[int],
    change: Callable[[int, U8], U8] = lambda _, rgb: rgb,
    without: Sequence[int] = (),
) -> None:
    """Write some frames of a clip, changed, with their annotations and truth, whole or not at all.

    Args:
        source: folder of `video.mp4`, `annotations.json` (entries by time) and `truth`.
        folder: of the new clip, in the same form.
        frames: source frames to keep, rising.
        change: makes the new picture, (h, w, 3), of a kept frame's number and picture.
        without: frames that keep no annotation.
    """
    truth = load_truth(source / "truth")
    work = folder.with_name(folder.name + ".part")
    shutil.rmtree(work, ignore_errors=True)
    (work / "truth").mkdir(parents=True)
    times = truth.times_s[list(frames)] - truth.times_s[frames[0]]
    _write_video(source / "video.mp4", work / "video.mp4", dict(zip(frames, times.tolist(), strict=True)), change)
    shown = {frame: time for frame, time in zip(frames, times.tolist(), strict=True) if frame not in without}
    _write_annotations(source, work, truth, shown)
    cameras = json.loads((source / "truth/cameras.json").read_text())
    cameras["cam_to_world"] = [cameras["cam_to_world"][frame] for frame in frames]
    cameras["times_s"] = times.tolist()
    defects = json.loads((source / "truth/defects.json").read_text())
    defects["visible"] = [defects["visible"][frame] for frame in frames]
    defects.pop("coverage", None)  # it is that of all frames
    (work / "truth/cameras.json").write_text(json.dumps(cameras), encoding="utf-8")
    (work / "truth/defects.json").write_text(json.dumps(defects), encoding="utf-8")
    shutil.copyfile(source / "truth/surface.ply", work / "truth/surface.ply")
    shutil.rmtree(folder, ignore_errors=True)
    work.rename(folder)


def _write_video(source: Path, target: Path, times: dict[int, float], change: Callable[[int, U8], U8]) -> None:
    with av.open(str(target), "w") as container:
        stream = None
        for index, _, _, rgb in iter_frames(source):
            if index not in times:
                continue
            if stream is None:
                fps = (len(times) - 1) / (max(times.values()) or 1.0)
                stream = video_stream(container, fps, rgb.shape[1], rgb.shape[0])
            picture = av.VideoFrame.from_ndarray(change(index, rgb), format="rgb24")
            picture.pts, picture.time_base = round(times[index] / TIME_BASE), TIME_BASE
            container.mux(stream.encode(picture))
        if stream is None:
            raise BadInput(f"{source} has none of the frames that were asked for", where="SOURCE")
        container.mux(stream.encode(None))


def _write_annotations(source: Path, work: Path, truth: Truth, shown: dict[int, float]) -> None:
    entries = json.loads((source / "annotations.json").read_text())
    if not isinstance(entries, dict):
        raise BadInput("the annotations are not entries by time", where="annotations.json")
    kept = {}
    for key, entry in entries.items():
        frame = truth.frame_at(float(key))
        if frame in shown:
            kept[f"{shown[frame]:.4f}"] = entry
    (work / "annotations.json").write_text(json.dumps(kept), encoding="utf-8")


def darkened(n_frames: int, count: int, light: float, seed: int = 0) -> tuple[list[int], Callable[[int, U8], U8]]:
    """The `count` middle ones of `n_frames`, and what turns a picture of them into one with a share of the light.

    The sensor's noise does not fall with the light: a share of 0 leaves noise alone.
    """
    start = (n_frames - count) // 2
    dark = list(range(start, start + count))

    def change(index: int, rgb: U8) -> U8:
        if index not in dark:
            return rgb
        noise = np.random.default_rng([seed, index]).normal(scale=NOISE, size=rgb.shape)
        faint = rgb / 255.0 * light ** (1.0 / TONE) + noise
        dimmed: U8 = np.clip(255.0 * faint, 0, 255).astype(np.uint8)
        return dimmed

    return dark, change


def make_slow(folder: Path) -> None:
    """Render the slow path as a scene of its own at 60 frames a second; a finished one is left as it is."""
    scene = replace(SLOW, n_frames=SLOW.n_frames * FAST_FPS // round(SLOW.fps), fps=float(FAST_FPS))
    make_missing(scene, folder, resampled(make_path(SLOW), scene.n_frames))


def rates(out: Path) -> list[Found]:
    """Run the slow clip whole and thinned: a score for each of `STEPS`, with its focal length, px of the picture."""
    whole = out / "scenes/every-1"
    make_slow(whole)
    found = []
    for step in STEPS:
        folder = out / f"scenes/every-{step}"
        if not folder.is_dir():
            rewrite(whole, folder, range(0, SLOW.n_frames * FAST_FPS // round(SLOW.fps), step))
        found.append(_run(out, folder, {"step": step}))
    return found


def dark_stretches(out: Path, source: Path, counts: Sequence[int], percents: Sequence[float]) -> list[Found]:
    """Run a clip with each number of middle frames at each percentage of the light: a score for each."""
    n_frames, found = load_truth(source / "truth").n_frames, []
    for count in counts:
        for percent in percents:
            folder = out / f"scenes/dark-{count}-{percent:g}"
            if not folder.is_dir():
                folder.parent.mkdir(parents=True, exist_ok=True)
                dark, change = darkened(n_frames, count, percent / 100.0)
                rewrite(source, folder, range(n_frames), change, without=dark)
            found.append(_run(out, folder, {"frames": count, "percent": percent}))
    return found


def _run(out: Path, folder: Path, named: Found) -> Found:
    """Score of a clip, kept as long as the program is the same."""

    def make() -> Found:
        run = out / "runs" / folder.name
        shutil.rmtree(run, ignore_errors=True)
        found = run_and_score(folder, load_truth(folder / "truth").roi, DEFAULT, run)
        return {"variant": folder.name, **named, "focal_px": _focal_px(run), **found}

    return kept_or_new(out / "results" / f"{folder.name}.json", program_digest()[:16], make)


def _focal_px(run: Path) -> float | None:
    if not (run / "sparse").is_dir():
        return None
    cameras = list(read_sparse(run / "sparse").cameras.values())
    return float(cameras[0].mean_focal_length()) if cameras else None
