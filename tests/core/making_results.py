"""Whole published results of a small scene: the stages from mapping on, and what publishing makes of them.

    python -m tests.core.making_results     writes tests/data/results anew

`one_model` has one model of a plane with its defects, and the gallery; `two_models` has two models of it, each with
defects; `refused` is a run whose search found no model.
"""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from types import ModuleType

from core.io.annotations import read_rows, write_rows
from core.io.timeline import read_defects, read_events, write_timeline
from core.products.contract import Facts
from core.products.front import FramesProduct, ProbeProduct
from core.products.search import ExtendProduct
from core.report.load import load_tables
from core.report.record import RunRecord, TaskRecord
from core.scene.detection import Outcome
from core.settings import make_settings
from core.stage import StageTask
from core.stages import gallery, map_defects, pictures, timeline, viewer
from core.states import RunState, TaskState
from core.surface.ply import write_mesh
from core.task_key import key_of
from core.videos import Recording
from core.viewer.deliver import bundle
from tests.core.making_products import facts_of
from tests.core.test_mapping_stages import SETTINGS, plane, sparse_model, write, write_inputs
from worker.publish import publish

RESULTS = Path(__file__).parents[1] / "data" / "results"
REGISTERED = {0: [0, 1, 2, 3], 1: [5, 6, 7]}
"""Frames of each model."""
_SIZE = {"crop": (0, 0, 160, 128), "source_width": 160, "source_height": 128}
_VERSIONS = {"bladeatlas": "test"}
"""The real ones would change the files with every release."""


def make(name: str, out: Path) -> None:
    """Make one of the results in a new folder."""
    with tempfile.TemporaryDirectory() as folder:
        work = Path(folder)
        {"one_model": _one_model, "two_models": _two_models, "refused": _refused}[name](work, out)
    shutil.rmtree(out / ".bladeatlas")
    for page in out.rglob("viewer"):
        for file in bundle():
            (page / file).unlink()


def opened(name: str, out: Path) -> Path:
    """A copy of a committed result with the built page, which is not committed once more; gives its folder."""
    shutil.copytree(RESULTS / name, out)
    for page in out.rglob("viewer"):
        for file, content in bundle().items():
            (page / file).write_bytes(content)
    return out


def _one_model(work: Path, out: Path) -> None:
    folders, facts = _begun(work)
    _model(0, work, folders, facts)
    _run(gallery, 0, work, folders, facts)
    _publish(_record(facts, folders), folders, out)


def _two_models(work: Path, out: Path) -> None:
    folders, facts = _begun(work)
    for submodel in REGISTERED:
        _model(submodel, work, folders, facts)
    _publish(_record(facts, folders), folders, out)


def _model(submodel: int, work: Path, folders: dict[str, Path], facts: dict[str, Facts]) -> None:
    """A model of the plane, and the stages from mapping to its page."""
    registered = REGISTERED[submodel]
    extend, mesh = work / key_of("extend", submodel), work / key_of("mesh", submodel)
    sparse_model(extend / "model", registered)
    write(extend / "registered.json", registered)
    mesh.mkdir()
    write_mesh(mesh / "mesh_poisson.ply", plane(41, 35))
    folders |= {extend.name: extend, mesh.name: mesh}
    facts |= {extend.name: facts_of(ExtendProduct, registered_images=len(registered)), mesh.name: {}}
    for stage in (map_defects, timeline):
        _run(stage, submodel, work, folders, facts)
    _number(folders[key_of("timeline", submodel)], submodel)
    _run(viewer, submodel, work, folders, facts)


def _number(folder: Path, submodel: int) -> None:
    """Give the tables of a further model its number, and its defects and events their own: the thesis's rules, whose
    short way is taken here, know one model alone."""
    if not submodel:
        return
    defects = [replace(one, id=one.id + 10, model=submodel) for one in read_defects(folder)]
    defects = [replace(one, events=tuple(event + 10 for event in one.events)) for one in defects]
    events = [replace(one, event_id=one.event_id + 10, defect_id=one.defect_id + 10) for one in read_events(folder)]
    rows = [
        replace(one, model=submodel, defect_id=None if one.defect_id is None else one.defect_id + 10)
        if one.outcome == Outcome.MAPPED
        else one
        for one in read_rows(folder)
    ]
    write_timeline(folder, events, defects, [])
    write_rows(folder, rows)


def _refused(work: Path, out: Path) -> None:
    folders, facts = _begun(work)
    record = _record(facts, folders)
    reason, message = "no_reconstruction", "no case has a model"
    lost = TaskRecord("reduce_coarse", TaskState.FAILED, reason, message)
    ended = replace(record, state=RunState.FAILED, tasks=[*record.tasks, lost], reason=reason, message=message)
    _publish(replace(ended, failed_stage="reduce_coarse"), folders, out)


def _begun(work: Path) -> tuple[dict[str, Path], dict[str, Facts]]:
    """Results of the stages before the model, and their facts."""
    write_inputs(work)
    folders = {name: work / name for name in ("probe", "frames", "annotations")}
    facts: dict[str, Facts] = {
        "probe": facts_of(ProbeProduct, n_frames=8, duration_s=0.64),
        "frames": facts_of(FramesProduct, n_frames=8, n_search=8, **_SIZE),
        "annotations": {},
    }
    _run(pictures, 0, work, folders, facts)
    return folders, facts


def _run(stage: ModuleType, submodel: int, work: Path, folders: dict[str, Path], facts: dict[str, Facts]) -> None:
    key = key_of(stage.__name__.rsplit(".", 1)[-1], submodel)
    out = work / key
    out.mkdir()
    args = {"piece": submodel} if submodel else {}
    task = StageTask(key, args, SETTINGS, dict(folders), dict(facts), (Recording(work / "video.mp4"),), out)
    facts[key] = stage.run(task).facts
    folders[key] = out


def _record(facts: Mapping[str, Facts], folders: Mapping[str, Path]) -> RunRecord:
    tasks = [TaskRecord(key, TaskState.SUCCEEDED, facts=own) for key, own in facts.items()]
    settings = make_settings("default", {"mapping.method": "thesis"})
    return RunRecord(settings, RunState.SUCCEEDED, tasks, load_tables(folders), {"video": "aa"}, _VERSIONS)


def _publish(record: RunRecord, folders: Mapping[str, Path], out: Path) -> None:
    hidden = out / ".bladeatlas"
    hidden.mkdir(parents=True)
    publish(record, folders, out, hidden)


if __name__ == "__main__":
    for _name in ("one_model", "two_models", "refused"):
        shutil.rmtree(RESULTS / _name, ignore_errors=True)
        make(_name, RESULTS / _name)
