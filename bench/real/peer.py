"""What a user would do with COLMAP alone, as a process of its own so that its time can be told.

SIFT on the processor, one camera for the clip, sequential matching with overlap 8, the lens as SIMPLE_RADIAL and not
told; everything else as COLMAP comes.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import cv2
import pycolmap

from core.video.decode import iter_frames

OVERLAP = 8
"""Frames that each frame is matched with, besides those 1, 2, 4, ... frames on, which COLMAP adds."""
CAMERA_MODEL = "SIMPLE_RADIAL"
SEED = 0


def export(video: Path, folder: Path) -> None:
    """Write every frame of a video as a picture, named by its number."""
    folder.mkdir(parents=True)
    for index, _, _, rgb in iter_frames(video):
        if not cv2.imwrite(str(folder / f"{index:04d}.png"), cv2.cvtColor(rgb, cv2.COLOR_RGB2BGR)):
            raise OSError(f"{folder} cannot be written")


def reconstruct(pictures: Path, out: Path) -> None:
    """Reconstruct a folder of pictures; the model with the most images, if there is any, is written to `out/sparse`."""
    pycolmap.set_random_seed(SEED)
    database, models = out / "database.db", out / "models"
    models.mkdir(parents=True)
    pycolmap.extract_features(
        database,
        pictures,
        camera_mode=pycolmap.CameraMode.SINGLE,
        reader_options=pycolmap.ImageReaderOptions(camera_model=CAMERA_MODEL),
        device=pycolmap.Device.cpu,
    )
    pycolmap.match_sequential(
        database,
        pairing_options=pycolmap.SequentialPairingOptions(overlap=OVERLAP),
        device=pycolmap.Device.cpu,
    )
    found = pycolmap.incremental_mapping(database, pictures, models)
    if found:
        best = max(found.values(), key=lambda model: (model.num_reg_images(), model.num_points3D()))
        (out / "sparse").mkdir()
        best.write(out / "sparse")


def main() -> None:
    """Read a folder of pictures or a video."""
    parser = argparse.ArgumentParser(prog="python -m bench.real.peer", description=__doc__)
    parser.add_argument("video", type=Path, help="folder of pictures, or a video")
    parser.add_argument("out", type=Path, help="folder that does not exist yet")
    arguments = parser.parse_args()
    arguments.out.mkdir(parents=True)
    pictures = arguments.video
    if not pictures.is_dir():
        pictures = arguments.out / "pictures"
        export(arguments.video, pictures)
    reconstruct(pictures, arguments.out)


if __name__ == "__main__":
    main()
