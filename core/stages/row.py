"""Stage `row`: axis and pitch of the row of blades that the surface shows best."""

from __future__ import annotations

from core.io.sparse import read_model
from core.io.surface import supported_mesh
from core.mapping.scene import oriented
from core.products.surface import RowProduct
from core.row.estimate import search_row
from core.row.files import write_found
from core.row.model import NoRow
from core.scene.views import views_of
from core.stage import StageTask
from core.surface.ply import read_mesh


def run(task: StageTask) -> RowProduct:
    """Write ``found.json``: the row, or why no motion between views looks like a turn."""
    views = views_of(read_model(task.input("extend")))
    mesh = oriented(read_mesh(supported_mesh(task.input("mesh"))), views)
    task.report(1, 4, "searching the row of blades")
    found = search_row(mesh, views, task.settings.seed)
    write_found(task.out, found)
    if isinstance(found, NoRow):
        return RowProduct(pitch_rad=None, reason=str(found.reason))
    return RowProduct(pitch_rad=round(found.pitch_rad, 6), reason=None)
