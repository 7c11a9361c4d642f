"""Features of one frame and their file (docs/stage-results.md)."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from core.errors import StageFailed

Descriptors = NDArray[np.float16] | NDArray[np.float32] | NDArray[np.uint8]


@dataclass(frozen=True)
class FrameFeatures:
    """Keypoints of one frame, strongest first."""

    keypoints: NDArray[np.float32]
    """(n, 2) x, y in crop pixels; pixel centres at (0.5, 0.5)."""
    scores: NDArray[np.float32]
    """(n,) detector's score, falling."""
    descriptors: Descriptors
    """(n, d): float16 of unit length (DISK), uint8 (SIFT)."""

    def __len__(self) -> int:
        return len(self.keypoints)


def strongest(features: FrameFeatures, count: int) -> FrameFeatures:
    """The first `count` keypoints, which are the strongest."""
    return FrameFeatures(features.keypoints[:count], features.scores[:count], features.descriptors[:count])


def feature_name(index: int) -> str:
    """File name of a frame's features."""
    return f"{index:04d}.npz"


def write_features(path: Path, features: FrameFeatures) -> None:
    """Write one frame's features; the bytes depend on the arrays alone."""
    np.savez(path, keypoints=features.keypoints, scores=features.scores, descriptors=features.descriptors)


def read_features(path: Path) -> FrameFeatures:
    """Read what `write_features` wrote; `StageFailed` when the file is missing or damaged."""
    try:
        with np.load(path, allow_pickle=False) as data:
            return FrameFeatures(data["keypoints"], data["scores"], data["descriptors"])
    except (OSError, KeyError, ValueError) as error:
        raise StageFailed(f"cannot read the features of a frame: {path.name}: {error}", where="features") from error


class _Files(dict[int, Path]):
    """Feature files by frame; asking for one that no chunk has is a broken plan."""

    def __missing__(self, frame: int) -> Path:
        raise StageFailed(f"frame {frame} has no features", where="features")


def feature_files(chunks: Iterable[Path]) -> dict[int, Path]:
    """Feature file of every frame, over the folders of all chunks; `StageFailed` for a frame without one."""
    return _Files({int(path.stem): path for folder in chunks for path in sorted(folder.glob("[0-9]*.npz"))})
