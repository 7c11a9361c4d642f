"""Stage `row`: axis and pitch of the row of blades that the surface shows best."""

from __future__ import annotations

from core.io.sparse import model_folder
from core.io.surface import supported_mesh
from core.mapping.facing import read_surface
from core.products.surface import RowProduct
from core.row.estimate import search_row
from core.row.files import write_found
from core.row.model import NoRow
from core.stage import StageTask


def run(task: StageTask) -> RowProduct:
    """Write ``found.json``: the row, or why no motion between views looks like a turn."""
    mesh, views = read_surface(model_folder(task.input("extend")), supported_mesh(task.input("mesh")))
    task.report(1, 4, "searching the row of blades")
    found = search_row(mesh, views, task.settings.seed)
    write_found(task.out, found)
    if isinstance(found, NoRow):
        return RowProduct(pitch_rad=None, reason=str(found.reason))
    return RowProduct(pitch_rad=round(found.pitch_rad, 6), reason=None)
