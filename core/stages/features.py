"""Stage `features`: keypoints and descriptors of a chunk of frames, one file per frame."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import torch

from core.features.blade_masks import blade_polygons, inside_blades
from core.features.extract import keep_keypoints, make_extractor, read_image
from core.features.io import feature_name, write_features
from core.stage import StageResult, StageTask


def run(task: StageTask) -> StageResult:
    """Detect features in frames [start, end)."""
    torch.set_num_threads(task.threads)
    start, end = int(task.args["start"]), int(task.args["end"])
    settings = task.settings.features
    frames = task.input("frames")
    extract = make_extractor(settings, task.threads)
    blades = _blades(task, frames) if settings.blade_masks_only else None
    counts = []
    for done, index in enumerate(range(start, end)):
        task.report(done, end - start, f"frame {index}")
        features = extract(read_image(frames / "images" / f"{index:04d}.jpg"))
        if blades is not None:
            polygons = blade_polygons(blades["masks"].get(str(blades["source_index"][index]), []))
            features = keep_keypoints(features, inside_blades(features.keypoints, polygons, blades["crop"]))
        write_features(task.out / feature_name(index), features)
        counts.append(len(features))
    task.report(1, 1)
    return StageResult(
        {
            "n_images": len(counts),
            "min_keypoints": min(counts, default=0),
            "mean_keypoints": round(sum(counts) / len(counts), 3) if counts else 0.0,
        }
    )


def _blades(task: StageTask, frames: Path) -> dict[str, Any]:
    """Masks by source index, the crop, and the source index of every frame."""
    rows = json.loads((frames / "frames.json").read_text())
    return {
        "masks": json.loads((task.input("annotations") / "masks.json").read_text()),
        "crop": json.loads((frames / "crop.json").read_text()),
        "source_index": {int(row["index"]): int(row["source_index"]) for row in rows},
    }
