"""What a scene is: everything that its video, its annotations and its truth follow from."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass, fields

VERSION = 4
"""Of the renderer: another one makes other scenes of the same description."""
LATER = ("blades_present", "stagger_deg", "shroud")
"""Fields that came when scenes had been rendered and kept: with their default they change no digest."""


@dataclass(frozen=True)
class Lens:
    """A fisheye: a pixel at r px from the image centre looks ``theta = r / F + K3 r^3`` off the axis."""

    width: int
    height: int
    fov_deg: float
    """Across the width."""
    bend: float = 0.0
    """K3 r^3 over theta at the left and right rim; negative = more magnified there than an equidistant lens."""


@dataclass(frozen=True)
class Span:
    """Frames start <= i < end."""

    start: int
    end: int


@dataclass(frozen=True)
class Scene:
    """One inspection; lengths in mm, angles in degrees, times in frames unless said otherwise."""

    name: str
    seed: int
    lens: Lens
    n_frames: int = 110
    fps: float = 12.0
    roi: tuple[float, float, float, float] = (0.02, 0.02, 0.98, 0.98)
    # the row
    blades_in_row: int = 64
    chord_mm: tuple[float, float] = (30.0, 24.0)
    """At root and tip."""
    stagger_deg: tuple[float, float] = (28.0, 50.0)
    """Of the chord against the axis, at root and tip."""
    blades_present: int | None = None
    """Only so many blades, from the one seen first; None = the whole row."""
    shroud: bool = False
    """The blades' tips are joined by a ring."""
    texture: float = 1.0
    """Strength of the surface's marks; 0 = perfectly even metal."""
    glare: float = 0.35
    """Strength of the highlights."""
    # the motion
    turn_deg: float = 46.0
    """The rotor turns by this much over the clip."""
    distance_mm: float = 42.0
    wobble_mm: float = 2.2
    """The hand strays by this much."""
    sweep_mm: float = 8.0
    """It is moved along the blades to and fro by this much, and by half of it to them and away."""
    stall: Span | None = None
    """The rotor stands still."""
    reverse_at: int | None = None
    """It turns back from here on."""
    jump_at: int | None = None
    jump_deg: float = 0.0
    """It is turned by this much between two frames."""
    # what is hard
    dark: Span | None = None
    """The lights are off."""
    casing: bool = False
    """Vanes that stand still with the probe are in view: a second rigid body."""
    soft_mm: float = 0.0
    """The blades bend by this much, differently in every frame."""
    overlay: bool = False
    """Text is burned into the picture."""
    noise: float = 0.008
    dropped: float = 0.0
    """Share of the frames that the video lacks."""
    jitter_s: float = 0.0
    """Standard deviation of the frame times: variable frame rate."""
    still: bool = False
    """Nothing moves at all."""
    # the detector
    n_defects: int = 8
    missed: float = 0.4
    false_boxes: float = 0.0
    """Per frame, on average."""
    masks: bool = False
    """Detections carry polygons."""
    expect: str = "mapped"
    """``flagged`` for a scene that no one can reconstruct."""

    def digest(self) -> str:
        """Of the description and the renderer's version."""
        usual = {one.name: one.default for one in fields(self)}
        told = {name: value for name, value in asdict(self).items() if name not in LATER or value != usual[name]}
        text = json.dumps([VERSION, told], sort_keys=True)
        return hashlib.sha256(text.encode()).hexdigest()


def named(scenes: Sequence[Scene]) -> dict[str, Scene]:
    """By name."""
    return {scene.name: scene for scene in scenes}
