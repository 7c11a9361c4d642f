"""Mapping of many detections onto a very fine mesh."""

from __future__ import annotations

import json
import tempfile
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from bench.speed.finished import FinishedRun
from bench.speed.timing import Row, Table, interleaved
from core.errors import BadInput
from core.stage import StageTask
from core.stages.map_defects import run as map_defects
from core.surface.ply import Mesh, read_mesh, write_mesh

DETECTIONS = 200
VERTICES = 1_400_000


def compare(run: FinishedRun, *, threads: int, repeat: int) -> Table:
    """Run the stage `map_defects` on the run's model with a refined surface and 200 detections."""
    with tempfile.TemporaryDirectory(prefix="bench-mapping-") as text:
        folder = Path(text)
        inputs = dict(run.folders)
        mesh = refine(read_mesh(run.folder("mesh") / "mesh_poisson.ply"), VERTICES)
        (folder / "mesh").mkdir()
        write_mesh(folder / "mesh" / "mesh_poisson.ply", mesh, ())
        (folder / "annotations").mkdir()
        detections = _detections(run)
        (folder / "annotations" / "detections.json").write_text(json.dumps(detections), encoding="utf-8")
        inputs.update(mesh=folder / "mesh", annotations=folder / "annotations")
        number = iter(range(repeat))
        mapped: list[int] = []

        def once() -> None:
            out = folder / f"out{next(number)}"
            out.mkdir()
            task = StageTask("map_defects", {}, run.settings, inputs, run.facts, (), out, threads)
            mapped.append(map_defects(task).outcomes.get("mapped", 0))

        timing = interleaved({"mapping": once}, repeat)["mapping"]
    return Table(
        "mapping",
        f"{len(detections)} detections onto {len(mesh.vertices):,} vertices, {threads} threads, median of {repeat}",
        (Row("whole stage", timing.median, "s", "under 5"), Row("of them mapped", mapped[0])),
    )


def _detections(run: FinishedRun) -> list[dict[str, object]]:
    """The run's detections, repeated or cut to the number, ids renewed."""
    rows = json.loads((run.folder("annotations") / "detections.json").read_text(encoding="utf-8"))
    if not rows:
        raise BadInput(f"the run in '{run.out}' has no detections", where="RESULT")
    return [{**rows[i % len(rows)], "id": i} for i in range(DETECTIONS)]


def refine(mesh: Mesh, n_vertices: int) -> Mesh:
    """The same surface with hardly more than `n_vertices` vertices: triangles split in four, again and again."""
    vertices, faces = mesh.vertices, mesh.faces
    while len(vertices) < n_vertices:
        count = _faces_with_edges(faces, n_vertices - len(vertices))
        vertices, split = _split(vertices, faces[:count])
        faces = np.concatenate([split, faces[count:]])
    return Mesh(vertices, faces, extra={"support": np.ones(len(vertices), np.float32)})


def _faces_with_edges(faces: NDArray[np.int32], n_edges: int) -> int:
    """How many of the first faces have `n_edges` edges between them, at most all."""
    edges = np.sort(faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1).astype(np.int64)
    _, first = np.unique(edges[:, 0] * (edges.max() + 1) + edges[:, 1], return_index=True)
    in_order = np.sort(first)
    return int(in_order[n_edges - 1] // 3 + 1) if n_edges <= len(in_order) else len(faces)


def _split(vertices: NDArray[np.float64], faces: NDArray[np.int32]) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
    edges = np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
    unique, inverse = np.unique(edges, axis=0, return_inverse=True)
    middle = (inverse.reshape(3, -1) + len(vertices)).astype(np.int32)
    a, b, c = faces.T
    ab, bc, ca = middle
    split = np.concatenate(
        [np.stack(corner, axis=1) for corner in ((a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca))]
    )
    return np.concatenate([vertices, vertices[unique].mean(axis=1)]), split.astype(np.int32)
