"""Which file of which stage is published under which name: the contract of OUTPUTS as one table."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from core.products.contract import Products
from core.products.search import BestCase
from core.scene.case import REDUCERS
from core.task_key import key_of

SPARSE = "sparse"
"""Folder of the sparse model."""
FUSED = "dense/fused.ply"
"""Fused point cloud."""
SURFACE = "dense/mesh_poisson.ply"
"""Supported surface."""
DEFECT_SURFACE = "mapping/mesh_defects.ply"
"""Surface in the colours of its defects."""
DEFECT_GLB = "mapping/mesh_defects.glb"
"""The same for 3D viewers, every blade a node of its own."""
CONFIDENCE = "mapping/confidence.json"
"""What the confidence of every placed detection is made of."""
DETECTIONS = "mapping/detections.json"
"""Rows of all detections."""
TIMELINE = "mapping/timeline.json"
"""Rows of all events."""
DEFECTS = "mapping/defects.json"
"""Records of the defects."""
FRAMES = "frames.csv"
"""Frames that took part."""
ROW = "row.json"
"""The row of blades."""
ROW_MAP = "row_map.svg"
"""Its map: blades seen, coverage, findings."""
LIMITS = "limits.json"
"""Findings compared with the limits of the shop, where these are told."""
GALLERY = "gallery"
"""Folder of the gallery."""
GALLERY_PAGE = f"{GALLERY}/index.html"
"""The page to open in it."""
VIEWER = "viewer"
"""Folder of the page of a model, below it: what the stages left, and what is written when it is published."""
VIEWER_PAGE = f"{VIEWER}/index.html"
"""The page to open."""
DOCUMENT = "viewer.json"
"""In that folder: what the page shows."""
SURFACE_GLB = "surface.glb"
"""In that folder: the surface."""
SPRITE = "sprite.jpg"
"""In that folder: thumbnails of all frames."""
PORTRAITS = "surface"
"""In that folder: pictures of the surface at each defect."""
QUALITY = "quality.json"
"""Verdict, flags and counts."""
SUMMARY = "summary.json"
"""What ran, and the headline numbers; written last."""
BEST_CASE = "{best}"
"""Stands for the task of the case that the search chose."""


@dataclass(frozen=True)
class Output:
    """One published file or folder."""

    path: str
    """Relative to the output folder."""
    sources: tuple[tuple[str, str], ...]
    """(task key, path in its result), best first: the first whose task has a result is published."""
    folder: bool = False
    """Every file below the source is published below `path`."""
    needs_trust: bool = False
    """Says where defects are, so it is not published when the model was refused."""


_OF_A_VIEWER: tuple[Output, ...] = (
    Output(f"{VIEWER}/{SURFACE_GLB}", (("viewer", SURFACE_GLB),), needs_trust=True),
    # The best views at full size: they take the places of those that `pictures` made at half of it.
    Output(f"{VIEWER}/frames", (("viewer", "frames"),), folder=True, needs_trust=True),
    Output(f"{VIEWER}/{PORTRAITS}", (("viewer", PORTRAITS),), folder=True, needs_trust=True),
)

OUTPUTS: tuple[Output, ...] = (
    Output(SPARSE, (("extend", "model"), ("confirm", "model"), (BEST_CASE, "model")), folder=True),
    Output(FUSED, (("fuse", "fused.ply"),)),
    Output(SURFACE, (("mesh", "mesh_poisson.ply"),)),
    Output("dense/mesh_full.ply", (("mesh", "mesh_full.ply"),)),
    Output(DEFECT_SURFACE, (("timeline", "mesh_defects.ply"),), needs_trust=True),
    Output(DEFECT_GLB, (("timeline", "mesh_defects.glb"),), needs_trust=True),
    Output("mapping/defect_points.ply", (("map_defects", "defect_points.ply"),), needs_trust=True),
    Output(CONFIDENCE, (("timeline", "confidence.json"),), needs_trust=True),
    Output(ROW, (("timeline", ROW),), needs_trust=True),
    Output(ROW_MAP, (("timeline", ROW_MAP),), needs_trust=True),
    Output("gallery", ((GALLERY, ""),), folder=True),
    Output(f"{VIEWER}/frames", (("pictures", "frames"),), folder=True),
    Output(f"{VIEWER}/{SPRITE}", (("pictures", SPRITE),)),
    *_OF_A_VIEWER,
)

TABLES: tuple[str, ...] = (
    FRAMES,
    "cases.csv",
    "cases.json",
    "mapping/detections.csv",
    DETECTIONS,
    "mapping/timeline.csv",
    TIMELINE,
    DEFECTS,
    QUALITY,
    SUMMARY,
)
"""Written for every run that ended, whatever it reached; summary.json last, so its presence says: complete."""


OF_FURTHER_MODELS: tuple[Output, ...] = (
    Output(SPARSE, (("extend", "model"),), folder=True),
    *(output for output in OUTPUTS if output.path.startswith(("dense/", "mapping/", "row"))),
    *_OF_A_VIEWER,
)
"""Published below ``models/N/`` for every further model that came to its end."""


def model_folder(folder: Path, model: int) -> Path:
    """Folder of the files of a model of a result: of the first model that of the result itself."""
    return folder / "models" / str(model) if model else folder


def path_of_model(model: int, path: str) -> str:
    """Published path of a file of a model: of the first model that of the result's own file."""
    return f"models/{model}/{path}" if model else path


def model_numbers(folder: Path) -> list[int]:
    """Numbers of the models of a result, from 0, rising."""
    return [0, *sorted(int(path.name) for path in (folder / "models").glob("*") if path.name.isdecimal())]


def is_of_page(path: str) -> bool:
    """Whether a published path is that of a file of a page: below ``viewer/`` or ``models/N/viewer/``."""
    parts = path.split("/")
    if len(parts) > 3 and parts[0] == "models" and parts[1].isdecimal():
        parts = parts[2:]
    return len(parts) > 1 and parts[0] == VIEWER


def evidence_name(defect: int) -> str:
    """File of a defect's picture in the gallery."""
    return f"defect_{defect:03d}.jpg"


def portrait_name(defect: int) -> str:
    """File of the picture of the surface at a defect."""
    return f"defect_{defect:03d}.jpg"


def best_case(products: Products) -> str:
    """Task key of the case that the search chose; empty before the first reducer."""
    for reducer in REDUCERS:
        found = products.find(BestCase, reducer)
        if found is not None and found.best:
            return key_of(found.kind, part=found.best)
    return ""
