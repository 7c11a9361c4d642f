"""Stage `blades`: the blades of the row that `row` found, with what the user knows of it, or why it is none."""

from __future__ import annotations

from core.io.sparse import read_model
from core.io.surface import supported_mesh
from core.mapping.scene import oriented
from core.products.surface import BladesProduct
from core.row.estimate import describe_row
from core.row.files import read_found, write_blades
from core.row.model import BladeRow, NoRow
from core.row.overlap import Hypothesis
from core.scene.views import views_of
from core.stage import StageTask
from core.surface.ply import read_mesh


def run(task: StageTask) -> BladesProduct:
    """Write ``blades.json``: the row with its blades, or why there is none."""
    found = read_found(task.input("row"))
    row = found if isinstance(found, NoRow) else _described(task, found)
    write_blades(task.out, row)
    if isinstance(row, NoRow):
        return BladesProduct(n_blades=0, reason=str(row.reason), flags=tuple(row.flags))
    return BladesProduct(n_blades=len(row.numbers), reason=None, flags=())


def _described(task: StageTask, found: Hypothesis) -> BladeRow | NoRow:
    views = views_of(read_model(task.input("extend")))
    mesh = oriented(read_mesh(supported_mesh(task.input("mesh"))), views)
    task.report(1, 4, "telling the blades apart")
    return describe_row(mesh, views, task.settings.seed, found, task.settings.row)
