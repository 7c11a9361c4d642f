"""Stage `graph`: all matches, those over gaps too, joined to one view graph, as arrays and as COLMAP's database."""

from __future__ import annotations

import numpy as np

from core.features.io import feature_files, read_features
from core.io.frames import read_frames
from core.matching.bridges import select
from core.products.front import GraphProduct
from core.stage import StageTask
from core.verification import read_camera
from core.viewgraph import (
    database_of,
    graph_counts,
    join_tables,
    read_dropped,
    read_pairs,
    write_database,
    write_graph,
)


def run(task: StageTask) -> GraphProduct:
    """Write ``graph.npz`` and ``database.db`` over all frames."""
    folders = [folder for _, folder in task.fan_in("matches")]
    if "bridge" in task.inputs:
        folders.append(task.input("bridge"))
    table = join_tables(read_pairs(folder) for folder in folders)
    if "bridge" in task.inputs:
        dropped = read_dropped(task.input("bridge"))
        table = select(table, np.array([tuple(pair) not in dropped for pair in table.pairs.tolist()], bool))
    write_graph(task.out, table)
    task.report(0.2, 1, "writing the database")
    n_frames = len(read_frames(task.input("frames")))
    files = feature_files(folder for _, folder in task.fan_in("features"))
    camera = read_camera(task.input("camera"))
    keypoints = (read_features(files[index]).keypoints for index in range(n_frames))
    write_database(database_of(task.out), camera, keypoints, table)
    task.report(1, 1)
    return GraphProduct(**graph_counts(table, n_frames))
