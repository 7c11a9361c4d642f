"""Stage `blades`: the blades of the row that `row` found, with what the user knows of it, or why it is none."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from core.io.frames import read_frames
from core.io.sparse import model_folder
from core.io.surface import supported_mesh
from core.mapping.facing import read_surface
from core.products.front import BridgeProduct
from core.products.surface import BladesProduct
from core.row.estimate import describe_row, without_leap
from core.row.files import read_blades, read_found, write_blades, write_on_first
from core.row.model import BladeRow, NoRow, UnknownRow
from core.row.on_first import ModelOfRow, of_further, put_on_first
from core.scene.views import Views
from core.stage import StageTask
from core.surface.ply import Mesh


def run(task: StageTask) -> BladesProduct:
    """Write ``blades.json``: the row with its blades, or why there is none.

    Of a further model ``on_first.json`` too: how its row lies on that of the first.
    """
    found, surface = read_found(task.input("row")), _surface(task.input("extend"), task.input("mesh"))
    told, seed = task.settings.row, task.settings.seed
    task.report(1, 4, "telling the blades apart")
    own_told = of_further(told) if task.submodel else told
    row = found if isinstance(found, NoRow) else describe_row(*surface, seed, found, own_told)
    if isinstance(row, BladeRow):
        row = without_leap(row, surface[1], *_moments_and_jumps(task))
    if task.submodel:
        task.report(3, 4, "putting them onto the row of the first model")
        row = _put_on_first(task, row, surface)
    write_blades(task.out, row)
    if isinstance(row, NoRow):
        return BladesProduct(n_blades=0, reason=str(row.reason), flags=tuple(row.flags))
    return BladesProduct(n_blades=len(row.numbers), reason=None, flags=())


def _put_on_first(task: StageTask, row: BladeRow | NoRow, surface: tuple[Mesh, Views]) -> BladeRow | NoRow:
    """Write how the row lies on that of the first model; gives it with its edges named as there."""
    seed = task.settings.seed
    first: BladeRow | NoRow = NoRow(UnknownRow.NOT_COMPUTED)
    if "blades" in task.inputs:
        first = read_blades(task.inputs["blades"])
    models = [
        ModelOfRow(first, *_surface(task.inputs["extend"], task.inputs["mesh"]), seed),
        ModelOfRow(row, *surface, seed),
    ]
    moments_s, jumps = _moments_and_jumps(task)
    row, on_first = put_on_first(models[0], models[1], task.submodel, moments_s, task.settings.row, jumps)
    write_on_first(task.out, on_first)
    return row


def _moments_and_jumps(task: StageTask) -> tuple[Mapping[int, float], Sequence[tuple[int, int]]]:
    """Moment of each frame, s, and the neighbouring frames between which the pictures jump."""
    jumps = task.products.of(BridgeProduct, "bridge").jumps if "bridge" in task.products else ()
    return read_frames(task.input("frames")).moment_of_index, jumps


def _surface(extend: Path, mesh: Path) -> tuple[Mesh, Views]:
    return read_surface(model_folder(extend), supported_mesh(mesh))
