"""Stage `prune`: the view graph without what a rejected model and triplets speak against, and the parts left of it."""

from __future__ import annotations

import numpy as np

from core.checks.parts import prune
from core.io.frames import read_frames
from core.io.sparse import read_model
from core.matching.jumps import positions
from core.products.search import PruneProduct
from core.sparse import view_graph
from core.stage import StageTask
from core.viewgraph import database_of, graph_counts, read_graph, write_database, write_graph


def run(task: StageTask) -> PruneProduct:
    """Write ``graph.npz`` and ``database.db`` as stage `graph` does; what follows after a rejection reads these."""
    frames = read_frames(task.input("frames"))
    graph = task.input("graph")
    position = positions(frames.moments_s, frames.n_search, frames.videos)
    found = prune(read_graph(graph), read_model(task.input("reduce_refine")), position, frames.n_search)
    write_graph(task.out, found.table)
    known = view_graph.read_frames(database_of(graph), 0, len(frames))
    keypoints = (xy.astype(np.float32) for xy in known.keypoints)
    write_database(database_of(task.out), known.camera, keypoints, found.table)
    task.report(1, 1, f"{len(found.parts)} parts")
    return PruneProduct(
        **graph_counts(found.table, len(frames)),
        doubted=found.n_rejected,
        cuts=tuple((cut, cut + 1) for cut in found.cuts),
        parts=tuple(found.parts),
    )
