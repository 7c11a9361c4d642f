"""Stage `blades`: the blades of the row that `row` found, with what the user knows of it, or why it is none."""

from __future__ import annotations

from core.io.sparse import model_folder
from core.io.surface import supported_mesh
from core.mapping.load import read_surface
from core.products.surface import BladesProduct
from core.row.estimate import describe_row
from core.row.files import read_found, write_blades
from core.row.model import BladeRow, NoRow
from core.row.overlap import Hypothesis
from core.stage import StageTask


def run(task: StageTask) -> BladesProduct:
    """Write ``blades.json``: the row with its blades, or why there is none."""
    found = read_found(task.input("row"))
    row = found if isinstance(found, NoRow) else _described(task, found)
    write_blades(task.out, row)
    if isinstance(row, NoRow):
        return BladesProduct(n_blades=0, reason=str(row.reason), flags=tuple(row.flags))
    return BladesProduct(n_blades=len(row.numbers), reason=None, flags=())


def _described(task: StageTask, found: Hypothesis) -> BladeRow | NoRow:
    mesh, views = read_surface(model_folder(task.input("extend")), supported_mesh(task.input("mesh")))
    task.report(1, 4, "telling the blades apart")
    return describe_row(mesh, views, task.settings.seed, found, task.settings.row)
