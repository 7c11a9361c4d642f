"""The part of Open3D that this project uses: tensors from arrays, ray casting on triangle meshes, and smoothing them.

Open3D's own stubs do not know that a tensor is made from an array or that arrays are taken for tensors, and they pull
in its machine-learning and plotting modules, which most of the checker's time would go to.
"""

from open3d import core as core
from open3d import geometry as geometry
from open3d import t as t
from open3d import utility as utility
