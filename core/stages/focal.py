"""Stage `focal`: what focal length the video gives when the search starts from one field of view."""

from __future__ import annotations

from functools import lru_cache

import torch

from core.features.io import FrameFeatures, feature_files, read_features
from core.io.frames import read_frames
from core.matching.keyframes import read_keyframes
from core.products.front import FocalProduct, FramesProduct
from core.sparse.focal import choose_spans, find_focal, joined
from core.sparse.lens import of_model, start_lens
from core.stage import StageTask


def run(task: StageTask) -> FocalProduct:
    """Map a few spans of keyframes from the task's field of view; a video that gives no model registers 0 images.

    The lens is of the run's model, unless the task names another.
    """
    torch.set_num_threads(task.threads)
    frames = task.products.of(FramesProduct, "frames")
    settings = of_model(task.settings, str(task.args.get("model", task.settings.camera.model)))
    files = feature_files(folder for _, folder in task.fan_in("features"))

    @lru_cache(maxsize=64)
    def load(index: int) -> FrameFeatures:
        return read_features(files[index])

    fov = float(task.args["fov_deg"])
    lens = start_lens(frames, settings.camera, fov)
    keyframes = read_keyframes(task.input("motion")).frames if task.has("motion") else range(frames.n_search)
    videos = read_frames(task.input("frames")).videos
    spans = choose_spans(keyframes, settings.camera.focal_span, settings.camera.focal_spans, load, videos)
    found = []
    for number, span in enumerate(spans):

        def report(share: float, message: str, number: int = number) -> None:
            task.report(number + share, len(spans), message)

        found.append(find_focal(span, lens, settings, load, report))
    task.report(1, 1)
    return joined(fov, settings.camera.model, found)
