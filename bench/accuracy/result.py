"""A result folder as the outputs contract describes it, read for scoring."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pycolmap
from numpy.typing import NDArray

from core.errors import BadInput
from core.json_files import read_json
from core.outputs import DEFECT_SURFACE, FUSED, ROW, SURFACE, model_folder, model_numbers
from core.report.csv_form import read_csv
from core.surface.ply import Mesh, read_mesh

F64 = NDArray[np.float64]
I32 = NDArray[np.int32]


@dataclass(frozen=True)
class Registered:
    """The registered images of a sparse model, in its own world frame, by the order of their names."""

    source_indices: list[int]
    """Source frame of every registered image."""
    centers: F64
    """(n, 3) camera centres."""
    rotations: F64
    """(n, 3, 3) world_from_cam."""


@dataclass(frozen=True)
class ResultModel(Registered):
    """One sparse model with its surface."""

    number: int
    mesh: Mesh | None
    cloud: Mesh | None
    row: dict[str, Any] | None = None
    """Its `row.json`; None in results of before."""
    blade_of_vertex: tuple[F64, I32] | None = None
    """(n, 3) vertices of the coloured surface and (n,) numbers of their blades, 0 = none; None where it tells none."""


@dataclass(frozen=True)
class Result:
    """A finished run."""

    models: dict[int, ResultModel]
    """By number; 0 is the headline model. Empty when nothing could be reconstructed."""
    detections: list[dict[str, Any]]
    """Rows of `mapping/detections.json`."""
    defects: list[dict[str, Any]]
    """Records of `mapping/defects.json`."""


def load_result(folder: Path) -> Result:
    """Read a result folder; missing models and mapping files are an outcome, a missing `frames.csv` is `BadInput`."""
    sources = source_indices_by_name(folder / "frames.csv")
    models: dict[int, ResultModel] = {}
    for number in model_numbers(folder):
        root = model_folder(folder, number)
        if (root / "sparse").is_dir():
            models[number] = _load_model(number, root, sources)
    return Result(models, _rows(folder / "mapping/detections.json"), _rows(folder / "mapping/defects.json"))


def source_indices_by_name(path: Path) -> dict[str, int]:
    """Source frame by image name of a run's `frames.csv`; `BadInput` where it is missing or in another form."""
    if not path.is_file():
        raise BadInput("this is not a result folder: it has no frames.csv", where="frames.csv")
    try:
        return {f"{int(row['index']):04d}.jpg": int(row["source_index"]) for row in read_csv(path)}
    except (KeyError, ValueError) as error:
        raise BadInput(f"frames.csv is not in the expected form: {error!r}", where="frames.csv") from None


def read_sparse(folder: Path) -> pycolmap.Reconstruction:
    """Read COLMAP's files of a sparse model; `BadInput` when they are none."""
    try:
        return pycolmap.Reconstruction(folder)
    except (ValueError, RuntimeError) as error:
        raise BadInput(f"the sparse model in {folder.parent.name} cannot be read: {error}", where="sparse") from None


def registered(model: pycolmap.Reconstruction, sources: Mapping[str, int]) -> Registered:
    """Cameras of a sparse model; `sources` gives the source frame of each image name.

    Raises:
        BadInput: the model has an image that `sources` does not know.
    """
    images = sorted((model.image(key) for key in model.reg_image_ids()), key=lambda image: str(image.name))
    unknown = [image.name for image in images if image.name not in sources]
    if unknown:
        raise BadInput(f"image {unknown[0]} of the sparse model is not among the frames of the clip", where="sparse")
    world_from_cam = [image.cam_from_world().inverse() for image in images]
    return Registered(
        source_indices=[sources[image.name] for image in images],
        centers=np.array([pose.translation for pose in world_from_cam], np.float64).reshape(-1, 3),
        rotations=np.array([pose.rotation.matrix() for pose in world_from_cam], np.float64).reshape(-1, 3, 3),
    )


def _load_model(number: int, root: Path, sources: Mapping[str, int]) -> ResultModel:
    cameras = registered(read_sparse(root / "sparse"), sources)
    return ResultModel(
        cameras.source_indices,
        cameras.centers,
        cameras.rotations,
        number=number,
        mesh=_surface(root / SURFACE),
        cloud=_surface(root / FUSED),
        row=_row(root / ROW),
        blade_of_vertex=_blades(_surface(root / DEFECT_SURFACE)),
    )


def _blades(mesh: Mesh | None) -> tuple[F64, I32] | None:
    blade = None if mesh is None else mesh.extra.get("blade")
    return None if mesh is None or blade is None else (mesh.vertices, blade.astype(np.int32))


def _row(path: Path) -> dict[str, Any] | None:
    try:
        row: dict[str, Any] = read_json(path)
    except FileNotFoundError:
        return None
    except ValueError as error:
        raise BadInput(f"{path.name} cannot be read: {error}", where=path.name) from None
    return row


def _surface(path: Path) -> Mesh | None:
    return read_mesh(path) if path.is_file() else None


def _rows(path: Path) -> list[dict[str, Any]]:
    if not path.is_file():
        return []
    try:
        rows = json.loads(path.read_text())
    except ValueError as error:
        raise BadInput(f"{path.name} cannot be read: {error}", where=path.name) from None
    if not isinstance(rows, list):
        raise BadInput(f"{path.name} is not a top-level array", where=path.name)
    return rows
