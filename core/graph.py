"""The stage graph: what a run consists of, in one pure place.

`expand` turns settings and the facts known so far into the list of tasks. It is called again whenever a
task ends, because some stages fan out over what an earlier one found (frames, windows, depth maps). The
same call with the same facts gives the same list, so a plan can be rebuilt after any crash.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from core.geometry.lens import PERSPECTIVE, LensModel
from core.products.contract import Facts, Products
from core.products.front import CameraProduct, FramesProduct
from core.products.search import ChoiceProduct, PruneProduct, ReducerProduct, RefinedProduct, SubmodelsProduct
from core.products.surface import UndistortProduct
from core.scene.case import CaseKind
from core.settings import Settings
from core.task_key import chunk_key, key_of, part_of, stage_of
from core.windows import Window, coarse_windows, refined_windows

ALL_VIEWS = 1_000_000
"""End of the one chunk of a further model, whose number of views the plan does not know yet."""


PINHOLE_STARTS_DEG = (55.0, 85.0)
"""Fields of view from which a lens without any distortion is tried beside the fisheye. The answer hardly depends on the
start, since nothing trades against the focal length; that two end alike is what makes it one."""
BY_A_WRONG_LENS = frozenset({"bent_model", "not_static", "two_motions"})
"""Findings that a lens of the wrong kind leads to; without parallax or a join another lens finds none either."""


@dataclass(frozen=True)
class TaskSpec:
    """One task of the plan. `key` is unique in a run; `depends` lists keys."""

    key: str
    depends: tuple[str, ...] = ()
    args: Mapping[str, Any] = field(default_factory=dict)
    optional: bool = False
    """An expected failure of this task is an outcome: tasks that depend on it go on without its result."""

    @property
    def stage(self) -> str:
        """Name of the stage in `STAGES`."""
        return stage_of(self.key)


def expand(settings: Settings, facts: Mapping[str, Facts]) -> list[TaskSpec]:
    """All tasks that follow from the facts known so far, in topological order.

    Args:
        settings: of the run.
        facts: of finished tasks by key; those of the stages that the plan unfolds over are read.

    Raises:
        StageFailed: the facts of such a stage cannot be used.
    """
    tasks = [
        TaskSpec("probe"),
        TaskSpec("annotations", ("probe",)),
        TaskSpec("frames", ("probe", "annotations")),
    ]
    if "frames" not in facts:
        return tasks
    done = Products(facts)
    frames = done.of(FramesProduct, "frames")
    front_end = _front_end(settings, frames.n_frames)
    tasks += front_end
    coarse = coarse_windows(frames.n_search, settings.windows)
    tasks += [_case(window, ("graph",)) for window in coarse]
    tasks.append(TaskSpec("reduce_coarse", tuple(_case_key(window) for window in coarse)))
    if "reduce_coarse" not in facts:
        return tasks
    return tasks + _from_search_on(settings, done, front_end)


def _front_end(settings: Settings, n_frames: int) -> list[TaskSpec]:
    """Features, keyframes, camera, matches and the verified view graph."""
    step = settings.compute.chunk_frames
    chunks = [(start, min(start + step, n_frames)) for start in range(0, n_frames, step)]
    # Other annotations of the same video need no new features, unless these keep to the annotated blades.
    needs = ("frames", "annotations") if settings.features.blade_masks_only else ("frames",)
    features = [TaskSpec(chunk_key("features", i), needs, {"start": a, "end": b}) for i, (a, b) in enumerate(chunks)]
    feature_keys = tuple(task.key for task in features)
    tasks = list(features)
    # Early: a run that finds no model shows its frames too. Without them the page still has its surface.
    tasks.append(TaskSpec("pictures", ("probe", "annotations", "frames"), optional=True))
    motion_keys: tuple[str, ...] = ()
    if settings.matching.keyframes:
        tasks.append(TaskSpec("motion", ("frames", *feature_keys)))
        motion_keys = ("motion",)
    focal_keys: tuple[str, ...] = ()
    told = settings.camera.fov_deg is not None or settings.camera.params is not None
    if not told and settings.camera.focal == "estimate":
        focal = [
            TaskSpec(
                key_of("focal", part=f"{fov:05.1f}"),
                ("frames", *feature_keys, *motion_keys),
                {"fov_deg": fov},
                optional=True,
            )
            for fov in settings.camera.fov_starts_deg
        ]
        if not _is_model_told(settings):
            # A preset with a single start is in a hurry here too.
            focal += [
                replace(
                    focal[0],
                    key=key_of("focal", part=f"{LensModel.PINHOLE}-{fov:05.1f}"),
                    args={"fov_deg": fov, "model": str(LensModel.PINHOLE)},
                )
                for fov in PINHOLE_STARTS_DEG[: len(focal)]
            ]
        tasks += focal
        focal_keys = tuple(task.key for task in focal)
    tasks.append(TaskSpec("camera", ("frames", *focal_keys)))
    matches = [
        TaskSpec(chunk_key("matches", i), ("frames", "camera", *feature_keys, *motion_keys), {"start": a, "end": b})
        for i, (a, b) in enumerate(chunks)
    ]
    tasks += matches
    match_keys = tuple(task.key for task in matches)
    bridge_keys: tuple[str, ...] = ()
    if settings.matching.bridge:
        tasks.append(TaskSpec("bridge", ("frames", "camera", *feature_keys, *match_keys)))
        bridge_keys = ("bridge",)
    tasks.append(TaskSpec("graph", ("frames", "camera", *feature_keys, *match_keys, *bridge_keys)))
    return tasks


def _from_search_on(settings: Settings, done: Products, front_end: Sequence[TaskSpec]) -> list[TaskSpec]:
    """Refinement, final model, dense surface, mapping."""
    n_search, chosen = done.of(FramesProduct, "frames").n_search, done.of(ChoiceProduct, "reduce_coarse")
    refined = refined_windows((chosen.start, chosen.end), n_search, settings.windows, chosen.best)
    tasks = [_case(window, ("graph", "reduce_coarse")) for window in refined]
    coarse_key = key_of("coarse", part=chosen.best)
    refine_keys = tuple(_case_key(window) for window in refined)
    tasks.append(TaskSpec("reduce_refine", ("annotations", "frames", "reduce_coarse", coarse_key, *refine_keys)))
    if "reduce_refine" not in done:
        return tasks
    winner = done.of(RefinedProduct, "reduce_refine")
    graph, reducer = "graph", "reduce_refine"
    if winner.vetoed:
        graph, reducer = "prune", "reduce_parts"
        tasks.append(TaskSpec("prune", ("frames", "graph", "reduce_refine")))
        if "prune" not in done:
            return tasks
        perspective = _perspective(settings, done, front_end)
        tasks += _parts(done.of(PruneProduct, "prune").parts, bool(perspective))
        if perspective and "reduce_parts" not in done:
            return tasks
        if perspective and not done.of(ReducerProduct, "reduce_parts").best:
            graph, reducer = "reverify", "reduce_perspective"
            tasks += perspective
    tasks.append(TaskSpec("confirm", ("frames", graph, reducer)))
    tasks.append(TaskSpec("extend", ("frames", "camera", graph, "confirm")))
    if settings.model.further:
        tasks.append(TaskSpec("pieces", ("frames", graph, "extend")))
    tasks.append(TaskSpec("undistort", ("frames", "extend")))
    if "undistort" not in done:
        return tasks
    return tasks + _dense_and_mapping(settings, done, graph)


def _parts(intervals: Sequence[tuple[int, int]], another_lens: bool) -> list[TaskSpec]:
    """The parts of a rejected model, each mapped alone, and the choice; `another_lens` follows where none passes."""
    windows = [Window(CaseKind.SECTION, i, start, end) for i, (start, end) in enumerate(intervals)]
    cases = [_case(window, ("prune",)) for window in windows]
    needs = ("annotations", "frames", "reduce_refine", *(one.key for one in cases))
    return [*cases, TaskSpec("reduce_parts", needs, {"another_lens": another_lens})]


def _is_model_told(settings: Settings) -> bool:
    """Whether somebody said of which kind the lens is: then no other is tried."""
    return settings.camera.model != LensModel.OPENCV_FISHEYE or "camera.model" in settings.overrides


def _perspective(settings: Settings, done: Products, front_end: Sequence[TaskSpec]) -> list[TaskSpec]:
    """The lens sought anew as a perspective one, the graph verified by it, and the best rejected window mapped so.

    None where somebody said what the lens is, where it is a perspective one already, or where what is wrong is not the
    lens's doing.
    """
    rejected = done.of(RefinedProduct, "reduce_refine")
    starts = [task for task in front_end if task.stage == "focal" and "model" not in task.args]
    lens = done.of(CameraProduct, "camera").model
    told = _is_model_told(settings) or not starts or lens != LensModel.OPENCV_FISHEYE
    if told or BY_A_WRONG_LENS.isdisjoint(rejected.codes.split(", ")):
        return []
    model = {"model": str(PERSPECTIVE)}
    keys = [key_of("focal", part=f"{PERSPECTIVE}-{part_of(start.key)}") for start in starts]
    starts = [replace(one, key=key, args={**one.args, **model}) for one, key in zip(starts, keys, strict=True)]
    case = _case(Window(CaseKind.PERSPECTIVE, 0, rejected.start, rejected.end), ("reverify",))
    choice = TaskSpec("reduce_perspective", ("reduce_refine", "reduce_parts", case.key))
    return [*starts, TaskSpec("reverify", ("frames", "graph", "reduce_parts", *keys), model), case, choice]


def _dense_and_mapping(settings: Settings, done: Products, graph: str) -> list[TaskSpec]:
    step, n_views = settings.compute.chunk_views, done.of(UndistortProduct, "undistort").n_views
    chunks = [(start, min(start + step, n_views)) for start in range(0, n_views, step)]
    tasks: list[TaskSpec] = []
    depth = [TaskSpec(chunk_key("depth", i), ("undistort",), {"start": a, "end": b}) for i, (a, b) in enumerate(chunks)]
    depth_keys = tuple(task.key for task in depth)
    geometric = [
        TaskSpec(chunk_key("geometric", i), ("undistort", *depth_keys), {"start": a, "end": b})
        for i, (a, b) in enumerate(chunks)
    ]
    fuse = TaskSpec("fuse", ("undistort", *(task.key for task in geometric)))
    tasks += [*depth, *geometric, fuse, TaskSpec("mesh", ("fuse",))]
    # Optional: a row that cannot be told is an outcome, and places are worth having without.
    shape = ("extend", "mesh")
    # Where the pictures jump the turn of the camera may leap.
    bridge = ("bridge",) if settings.matching.bridge else ()
    tasks.append(TaskSpec("row", shape, optional=True))
    tasks.append(TaskSpec("blades", ("frames", *bridge, *shape, "row"), optional=True))
    dense_keys = ("undistort", *(task.key for task in geometric), "fuse", "mesh")
    tasks.append(TaskSpec("map_defects", ("probe", "annotations", "frames", graph, "extend", *dense_keys)))
    tasks.append(TaskSpec("timeline", ("annotations", "frames", "extend", "fuse", "mesh", "blades", "map_defects")))
    tasks.append(TaskSpec("viewer", ("frames", "pictures", "extend", "mesh", "timeline")))
    if settings.model.further and "pieces" not in done:
        return tasks
    n_submodels = done.of(SubmodelsProduct, "pieces").n_pieces if settings.model.further else 0
    timelines = [key_of("timeline", submodel) for submodel in range(n_submodels + 1)]
    for submodel in range(1, n_submodels + 1):
        tasks += _of_submodel(submodel, timelines[:submodel], graph, bridge)
    tasks.append(TaskSpec("gallery", ("probe", "annotations", "frames", "map_defects", *timelines)))
    return tasks


def _of_submodel(submodel: int, timelines: Sequence[str], graph: str, bridge: tuple[str, ...]) -> list[TaskSpec]:
    """Everything from the final model on for a further model, one task per stage; failing ones are an outcome."""

    def key(stage: str) -> str:
        return key_of(stage, submodel)

    depth, geometric = chunk_key("depth", 0, submodel), chunk_key("geometric", 0, submodel)
    whole = {"piece": submodel, "start": 0, "end": ALL_VIEWS}
    one = {"piece": submodel}
    shape = (key("extend"), key("mesh"))
    surface = (key("extend"), key("fuse"), key("mesh"))
    grouped = ("annotations", "frames", *surface, key("blades"), key("map_defects"), *timelines)
    return [
        TaskSpec(key("extend"), ("frames", "camera", graph, "pieces"), one, optional=True),
        TaskSpec(key("undistort"), ("frames", "pieces", key("extend")), one, optional=True),
        TaskSpec(depth, (key("undistort"),), whole, optional=True),
        TaskSpec(geometric, (key("undistort"), depth), whole, optional=True),
        TaskSpec(key("fuse"), (key("undistort"), geometric), one, optional=True),
        TaskSpec(key("mesh"), (key("fuse"),), one, optional=True),
        TaskSpec(key("row"), shape, one, optional=True),
        # The row of a further model is put onto that of the first, and not over a jump of the pictures.
        TaskSpec(
            key("blades"), ("frames", *bridge, "extend", "mesh", "blades", *shape, key("row")), one, optional=True
        ),
        TaskSpec(
            key("map_defects"),
            ("probe", "annotations", "frames", graph, key("undistort"), geometric, *surface),
            one,
            optional=True,
        ),
        TaskSpec(key("timeline"), grouped, one, optional=True),
        TaskSpec(
            key("viewer"), ("frames", "pictures", key("extend"), key("mesh"), key("timeline")), one, optional=True
        ),
    ]


def _case_key(window: Window) -> str:
    return key_of(window.kind, part=window.name)


def _case(window: Window, depends: tuple[str, ...]) -> TaskSpec:
    """One reconstruction case; a failed case is an outcome, the search goes on without it."""
    args: dict[str, Any] = {
        "name": window.name,
        "start": window.start,
        "end": window.end,
        "warm_from": window.warm_from,
    }
    if window.warm_from:
        depends = (*depends, key_of("coarse", part=window.warm_from))
    return TaskSpec(_case_key(window), depends, args, optional=True)
