from __future__ import annotations

import json
import struct
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import trimesh

from core.scene.size import Scale
from core.surface.colored_glb import write_glb
from core.surface.cut import by_blade
from core.surface.glb import vertex_normals
from core.surface.ply import Mesh

MESH = Mesh(
    vertices=np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 5]]),
    faces=np.array([[0, 1, 2], [0, 2, 3]], np.int32),
    colors=np.array([[255, 0, 0], [180, 180, 180], [0, 0, 0], [10, 20, 30]], np.uint8),
    extra={"support": np.array([0, 0.25, 0.5, 1], np.float32), "defect_id": np.array([-1, 2, 0, 70000], np.int32)},
)


def test_other_software_reads_it_y_up(tmp_path: Path) -> None:
    write_glb(tmp_path / "m.glb", MESH)
    read = trimesh.load(tmp_path / "m.glb", force="mesh", process=False)
    assert read.vertices == pytest.approx(MESH.vertices * [1, -1, -1])
    assert read.faces.tolist() == MESH.faces.tolist()
    assert read.vertex_attributes["_SUPPORT"].ravel() == pytest.approx([0, 0.25, 0.5, 1])
    assert read.vertex_attributes["_DEFECT_ID"].ravel().tolist() == [-1, 2, 0, 70000]
    # The turn to y-up is a rotation: faces keep their winding, normals turn along.
    assert read.face_normals == pytest.approx(np.array([[0, 0, -1], [1, 0, 0]]), abs=1e-6)


def test_chunks_are_whole_and_aligned(tmp_path: Path) -> None:
    write_glb(tmp_path / "m.glb", MESH)
    data = (tmp_path / "m.glb").read_bytes()
    magic, version, total = struct.unpack_from("<4sII", data)
    length, kind = struct.unpack_from("<I4s", data, 12)
    document = json.loads(data[20 : 20 + length])
    assert (magic, version, total, kind) == (b"glTF", 2, len(data), b"JSON")
    assert length % 4 == 0
    binary = struct.unpack_from("<I", data, 20 + length)[0]
    assert document["buffers"][0]["byteLength"] == binary
    assert all(view["byteOffset"] % 4 == 0 for view in document["bufferViews"])
    assert document["asset"]["extras"]["unit"] == "model"


def test_every_blade_is_a_node_and_all_faces_stay(tmp_path: Path) -> None:
    mesh = replace(MESH, extra={**MESH.extra, "blade": np.array([2, 2, 0, 0], np.int32)})
    write_glb(tmp_path / "m.glb", mesh, Scale(2.0, 0.1, "row"))
    scene = trimesh.load(tmp_path / "m.glb", process=False)
    assert isinstance(scene, trimesh.Scene)
    assert set(scene.geometry) == {"blade_2", "surface with defects"}
    blade, other = scene.geometry["blade_2"], scene.geometry["surface with defects"]
    assert blade.vertices == pytest.approx(0.002 * MESH.vertices[[0, 1, 2]] * [1, -1, -1])
    assert other.vertices == pytest.approx(0.002 * MESH.vertices[[0, 2, 3]] * [1, -1, -1])
    assert other.vertex_attributes["_DEFECT_ID"].ravel().tolist() == [-1, 0, 70000]
    assert by_blade(MESH, "all") == {"all": MESH}
    # Where two parts meet both have the normals of the whole.
    whole = vertex_normals(MESH)
    assert by_blade(mesh, "all")["all"].normals == pytest.approx(whole[[0, 2, 3]])


def test_colours_are_linear_as_gltf_wants(tmp_path: Path) -> None:
    write_glb(tmp_path / "m.glb", MESH)
    data = (tmp_path / "m.glb").read_bytes()
    length = struct.unpack_from("<I", data, 12)[0]
    document = json.loads(data[20 : 20 + length])
    accessor = document["accessors"][document["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"]]
    start = 28 + length + document["bufferViews"][accessor["bufferView"]]["byteOffset"]
    colors = np.frombuffer(data, "<u2", 16, start).reshape(4, 4) / 65535
    assert colors[0].tolist() == [1, 0, 0, 1]
    assert colors[1, 0] == pytest.approx(0.4564, abs=1e-4)  # sRGB 180 / 255


def test_vertex_normals_are_unit_also_where_no_face_is() -> None:
    mesh = Mesh(np.vstack([MESH.vertices, [[9, 9, 9]]]), MESH.faces)
    normals = vertex_normals(mesh)
    assert np.linalg.norm(normals, axis=1) == pytest.approx(np.ones(5))
    assert normals[1] == pytest.approx((0, 0, 1))
