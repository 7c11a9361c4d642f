"""The verified view graph: pairs as arrays, their files, statistics, and COLMAP's database of them."""

from __future__ import annotations

import json
import time
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, fields
from pathlib import Path
from typing import TypedDict

import cv2  # noqa: F401  (before pycolmap: the other order aborts in PNG writing)
import numpy as np
import pycolmap
from numpy.typing import NDArray
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from core.errors import StageFailed
from core.matched_pair import MatchedPair
from core.scene.frame import image_name

_PAIRS = "pairs.npz"
_GRAPH = "graph.npz"
_DATABASE = "database.db"
_DROPPED = "dropped.json"

OPENING_S = 30.0
"""For so long opening a database is tried; what locks it takes milliseconds."""
OPENING_EVERY_S = 0.02


@dataclass(frozen=True)
class PairTable:
    """Matched pairs as arrays, the content of ``pairs.npz`` and ``graph.npz`` (docs/stage-results.md)."""

    pairs: NDArray[np.int32]
    """(m, 2) frame indices i < j."""
    method: NDArray[np.uint8]
    """(m,) 0 mutual nearest, 1 LightGlue."""
    n_matches: NDArray[np.int32]
    """(m,) matches before verification."""
    config: NDArray[np.uint8]
    """(m,) COLMAP's two-view configuration."""
    offsets: NDArray[np.int64]
    """(m + 1,) rows of `inliers` of each pair; a pair that was not verified has none."""
    inliers: NDArray[np.uint32]
    """(total, 2) keypoint indices."""
    rotation_xyzw: NDArray[np.float64]
    """(m, 4) of cam2_from_cam1."""
    translation: NDArray[np.float64]
    """(m, 3) of cam2_from_cam1, unit length or zero."""
    triangulation_angle_deg: NDArray[np.float32]
    """(m,) median over the inliers."""

    @property
    def n_inliers(self) -> NDArray[np.int64]:
        """(m,) inliers of every pair."""
        return np.diff(self.offsets)

    @property
    def verified(self) -> NDArray[np.bool_]:
        """(m,) which pairs passed the verification."""
        return self.n_inliers > 0


def make_table(pairs: Sequence[tuple[int, int]], matched: Sequence[MatchedPair]) -> PairTable:
    """Table of the outcomes of `pairs`, in the same order."""
    found = [pair.geometry for pair in matched]
    return PairTable(
        np.array(pairs, np.int32).reshape(-1, 2),
        np.array([pair.method for pair in matched], np.uint8),
        np.array([pair.n_matches for pair in matched], np.int32),
        np.array([geometry.config for geometry in found], np.uint8),
        np.cumsum([0, *(len(geometry.inliers) for geometry in found)]).astype(np.int64),
        np.concatenate([np.empty((0, 2), np.uint32), *(geometry.inliers for geometry in found)]),
        np.array([geometry.rotation_xyzw for geometry in found], np.float64).reshape(-1, 4),
        np.array([geometry.translation for geometry in found], np.float64).reshape(-1, 3),
        np.array([geometry.triangulation_angle_deg for geometry in found], np.float32),
    )


def join_tables(tables: Iterable[PairTable]) -> PairTable:
    """All pairs of `tables`, sorted; `StageFailed` when a pair occurs twice."""
    parts = list(tables)
    if not parts:
        return make_table([], [])
    joined = {
        field.name: np.concatenate([getattr(part, field.name) for part in parts])
        for field in fields(PairTable)
        if field.name != "offsets"
    }
    counts = np.concatenate([part.n_inliers for part in parts])
    starts = np.cumsum(counts) - counts
    order = np.lexsort((joined["pairs"][:, 1], joined["pairs"][:, 0]))
    rows = [np.arange(starts[i], starts[i] + counts[i]) for i in order]
    inliers = joined.pop("inliers")[np.concatenate([np.empty(0, np.int64), *rows])]
    arrays = {name: values[order] for name, values in joined.items()}
    if len(np.unique(arrays["pairs"], axis=0)) != len(order):
        raise StageFailed("a pair of frames was matched twice", where="graph")
    return PairTable(offsets=np.cumsum([0, *counts[order]]).astype(np.int64), inliers=inliers, **arrays)


def write_table(path: Path, table: PairTable) -> None:
    """Write the arrays as npz; the bytes depend on the arrays alone."""
    np.savez(path, **{field.name: getattr(table, field.name) for field in fields(PairTable)})


def read_table(path: Path) -> PairTable:
    """Read what `write_table` wrote; `StageFailed` when the file is missing or damaged."""
    try:
        with np.load(path, allow_pickle=False) as data:
            return PairTable(**{field.name: data[field.name] for field in fields(PairTable)})
    except (OSError, KeyError, ValueError) as error:
        raise StageFailed(f"cannot read the matches {path.name}: {error}", where="matches") from error


def write_pairs(folder: Path, table: PairTable) -> None:
    """Write the pairs of a chunk of frames, or those of `bridge`."""
    write_table(folder / _PAIRS, table)


def read_pairs(folder: Path) -> PairTable:
    """Read what `write_pairs` wrote; `StageFailed` when the file is missing or damaged."""
    return read_table(folder / _PAIRS)


def write_graph(folder: Path, table: PairTable) -> None:
    """Write all pairs, the result of stage `graph` beside its database."""
    write_table(folder / _GRAPH, table)


def read_graph(folder: Path) -> PairTable:
    """Read what `write_graph` wrote; `StageFailed` when the file is missing or damaged."""
    return read_table(folder / _GRAPH)


def database_of(folder: Path) -> Path:
    """COLMAP's database of all frames and verified pairs, in the result of stage `graph`."""
    return folder / _DATABASE


@contextmanager
def open_database(path: Path) -> Iterator[pycolmap.Database]:
    """Open what `write_database` wrote, to read it.

    Tasks of several processes read the same file. SQLite locks it for a moment where its last reader closes it, and
    COLMAP does not wait for that, so opening is tried for `OPENING_S`.

    Raises:
        StageFailed: it cannot be opened.
    """
    deadline = time.monotonic() + OPENING_S
    while True:
        try:
            database = pycolmap.Database.open(path)
            break
        except RuntimeError as error:
            if time.monotonic() > deadline:
                raise StageFailed(f"COLMAP's database cannot be opened: {error}", where=path.name) from error
            time.sleep(OPENING_EVERY_S)
    with database:
        yield database


def write_dropped(folder: Path, pairs: NDArray[np.int32]) -> None:
    """Write the (m, 2) pairs over jumps that `bridge` takes out."""
    (folder / _DROPPED).write_text(json.dumps(pairs.tolist()))


def read_dropped(folder: Path) -> set[tuple[int, int]]:
    """The pairs that `write_dropped` wrote."""
    return {(first, second) for first, second in json.loads((folder / _DROPPED).read_text())}


class TableCounts(TypedDict):
    """Counts of a table of pairs."""

    n_pairs: int
    n_verified: int
    n_lightglue: int
    n_inliers: int


class GraphCounts(TypedDict):
    """Counts of a view graph; see `core.products.front.GraphProduct`."""

    n_pairs: int
    n_verified: int
    largest_component: int
    median_triangulation_angle_deg: float


def table_counts(table: PairTable) -> TableCounts:
    """Counts of one chunk of matches."""
    return {
        "n_pairs": len(table.pairs),
        "n_verified": int(table.verified.sum()),
        "n_lightglue": int((table.method == 1).sum()),
        "n_inliers": len(table.inliers),
    }


def graph_counts(table: PairTable, n_frames: int) -> GraphCounts:
    """Counts of the whole graph; the largest component counts frames joined by verified pairs."""
    verified = table.verified
    first, second = table.pairs[verified].T
    links = coo_matrix((np.ones(len(first), np.int8), (first, second)), shape=(n_frames, n_frames))
    _, labels = connected_components(links, directed=False)
    angles = table.triangulation_angle_deg[verified]
    return {
        "n_pairs": len(table.pairs),
        "n_verified": int(verified.sum()),
        "largest_component": int(np.bincount(labels).max()) if n_frames else 0,
        "median_triangulation_angle_deg": round(float(np.median(angles)), 4) if len(angles) else 0.0,
    }


def write_database(
    path: Path, camera: pycolmap.Camera, keypoints: Iterable[NDArray[np.float32]], table: PairTable
) -> None:
    """Write COLMAP's database: one camera, a trivial rig, one image and frame for every item of `keypoints`.

    Image `i` is called ``{i:04d}.jpg`` and has image_id = frame_id = i + 1. The mapper reads verified
    pairs alone, so raw matches and descriptors are left out.

    Args:
        path: file that does not exist yet.
        camera: `core.verification.camera_from_dict`.
        keypoints: (n, 2) pixels of every frame in order.
        table: pairs of these frames.
    """
    with pycolmap.Database.open(path) as database, pycolmap.DatabaseTransaction(database):
        database.write_camera(camera, use_camera_id=True)
        rig = pycolmap.Rig(rig_id=1)
        rig.add_ref_sensor(camera.sensor_id)
        database.write_rig(rig, use_rig_id=True)
        for index, points in enumerate(keypoints):
            _write_image(database, camera, index, points)
        for row in np.flatnonzero(table.verified).tolist():
            first, second = table.pairs[row].tolist()
            database.write_two_view_geometry(first + 1, second + 1, _geometry(table, row))


def _write_image(database: pycolmap.Database, camera: pycolmap.Camera, index: int, points: NDArray[np.float32]) -> None:
    image = pycolmap.Image(name=image_name(index), camera_id=camera.camera_id, image_id=index + 1)
    database.write_image(image, use_image_id=True)
    frame = pycolmap.Frame()
    frame.frame_id, frame.rig_id = index + 1, 1
    frame.add_data_id(image.data_id)
    database.write_frame(frame, use_frame_id=True)
    database.write_keypoints(index + 1, np.ascontiguousarray(points, np.float32))


def _geometry(table: PairTable, row: int) -> pycolmap.TwoViewGeometry:
    """One row as COLMAP's two-view geometry, its motion included."""
    geometry = pycolmap.TwoViewGeometry()
    geometry.config = int(table.config[row])
    geometry.inlier_matches = table.inliers[table.offsets[row] : table.offsets[row + 1]]
    rotation = pycolmap.Rotation3d(table.rotation_xyzw[row])
    geometry.cam2_from_cam1 = pycolmap.Rigid3d(rotation, table.translation[row])
    geometry.tri_angle = float(np.radians(table.triangulation_angle_deg[row]))
    return geometry
