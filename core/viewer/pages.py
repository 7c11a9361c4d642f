"""The pages of a run that ended, one for each of its models, written when it is published.

The stages left surface, poses and pictures; verdict and flags are known only when everything has ended.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from core.flags import Verdict
from core.json_files import JsonObject, read_json
from core.outputs import CONFIDENCE, ROW, SURFACE_GLB, VIEWER
from core.report.build import Report
from core.report.load import served_submodels
from core.task_key import key_of
from core.viewer.deliver import write_page
from core.viewer.document import ViewerSource
from core.viewer.scene import Pictures, ViewerScene


def write_pages(report: Report, folders: Mapping[str, Path], files: Mapping[str, Path], out: Path) -> list[str]:
    """Write the pages below `out`; gives their paths. A run that shows no frame has none.

    Args:
        report: of the run.
        folders: result folder of every finished task by key.
        files: published files of results by their paths.
        out: folder that gets `viewer/`, and `models/N/viewer/` for further models.
    """
    if not report.frames:
        return []
    pictures = _read_pictures(folders)
    trusted = report.verdict != Verdict.REFUSED
    submodels = (
        [submodel for submodel in served_submodels(folders) if key_of("viewer", submodel) in folders] if trusted else []
    )
    models = (0, *submodels)
    scenes = {model: _scene(folders, model) for model in models}
    first = scenes[0]
    if pictures is not None and first is not None and trusted:
        pictures = pictures.with_full(first.full)
    written = []
    for model in models:
        below = f"models/{model}/" if model else ""
        confidence = files.get(f"{below}{CONFIDENCE}")
        source = ViewerSource(
            report=report,
            scene=scenes[model],
            pictures=pictures,
            model=model,
            models=models,
            row=_object(files.get(f"{below}{ROW}")),
            sigmas={} if confidence is None else {one["id"]: one["position_sigma"] for one in read_json(confidence)},
            no_pictures="The pictures of the frames could not be written.",
        )
        surface = files.get(f"{below}{VIEWER}/{SURFACE_GLB}")
        written += [f"{below}{VIEWER}/{name}" for name in write_page(out / below / VIEWER, source, surface)]
    return written


def _read_pictures(folders: Mapping[str, Path]) -> Pictures | None:
    return Pictures.read(folders["pictures"]) if "pictures" in folders else None


def _scene(folders: Mapping[str, Path], model: int) -> ViewerScene | None:
    key = key_of("viewer", model)
    return ViewerScene.read(folders[key]) if key in folders else None


def _object(path: Path | None) -> JsonObject | None:
    return None if path is None else read_json(path)
