"""`bladeatlas-bench soak`: cut a clip so that many jobs fit, run the soak, print a table, keep the figures as JSON."""

from __future__ import annotations

import argparse
import json
from collections import Counter
from dataclasses import asdict
from pathlib import Path

import av

from bench.soak.run import Outcome, SoakSettings, disturbed, undisturbed
from core.errors import StageFailed
from core.states import InspectionState

_DEFAULTS = SoakSettings(Path("samples/turbine.mp4"), Path("samples/turbine.json"))


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Everything that a soak can be told."""
    parser.add_argument(
        "out", type=Path, metavar="DIR", help="folder for everything; the undisturbed run in it is kept"
    )
    parser.add_argument("--video", type=Path, default=_DEFAULTS.video, help="clip of every job")
    parser.add_argument("--annotations", type=Path, default=_DEFAULTS.annotations)
    parser.add_argument("--toy", action="store_true", help="stages that only take a moment: a minute instead of hours")
    for name, text in (
        ("jobs", "jobs"),
        ("faults", "faults"),
        ("workers", "worker processes"),
        ("seed", "of the faults"),
    ):
        parser.add_argument(f"--{name}", type=int, default=getattr(_DEFAULTS, name), metavar="N", help=text)
    parser.add_argument("--pause-s", type=float, default=_DEFAULTS.pause_s, help="mean time between faults")
    parser.add_argument("--preset", default=_DEFAULTS.preset)
    parser.add_argument("--options", type=json.loads, default={}, metavar="JSON", help="of every job, over the preset")
    parser.add_argument("--frames", type=int, default=0, metavar="N", help="take the first N frames, 480 px wide")


def command(arguments: argparse.Namespace) -> None:
    """Run both deployments; StageFailed when anything is not as it must be."""
    names = ("jobs", "faults", "workers", "seed", "toy", "pause_s", "preset", "options")
    out = arguments.out.resolve()
    video, annotations = arguments.video.resolve(), arguments.annotations.resolve()
    if arguments.frames:
        video, annotations = cut(video, annotations, out / "clip", arguments.frames, width=480)
    settings = SoakSettings(video, annotations, **{name: getattr(arguments, name) for name in names})
    kind = f"{'toy' if settings.toy else settings.preset}-{settings.jobs}"
    reference = undisturbed(settings, out / f"undisturbed-{kind}")
    found = disturbed(settings, out / f"disturbed-{kind}", out / f"undisturbed-{kind}")
    report = {"schema_version": 1, "undisturbed": asdict(reference), "disturbed": asdict(found)}
    (out / "soak.json").write_text(json.dumps(report, indent=1), encoding="utf-8")
    print(table(settings, reference, found))
    if reference.wrong or found.wrong:
        raise StageFailed("the soak found what must not be; see the table and soak.json", where="soak")


def table(settings: SoakSettings, reference: Outcome, found: Outcome) -> str:
    """The figures in a few lines of Markdown."""
    faults = ", ".join(f"{name} {count}" for name, count in sorted(Counter(found.faults).items()))
    rows = [
        ("jobs that succeeded", _succeeded(reference), _succeeded(found)),
        ("seconds", f"{reference.seconds:g}", f"{found.seconds:g}"),
        ("faults", "0", f"{len(found.faults)} of {settings.faults}: {faults}"),
        ("messages delivered twice", "0", str(found.duplicates)),
        ("attempts", _counts(reference.attempts), _counts(found.attempts)),
        ("wrong", str(len(reference.wrong)), str(len(found.wrong))),
    ]
    lines = ["| | undisturbed | with faults |", "| --- | --- | --- |"]
    lines += [f"| {name} | {one} | {other} |" for name, one, other in rows]
    return "\n".join([*lines, *(f"- {wrong}" for wrong in (*reference.wrong, *found.wrong))])


def _succeeded(outcome: Outcome) -> str:
    succeeded = sum(state == InspectionState.SUCCEEDED for state in outcome.states.values())
    return f"{succeeded} of {len(outcome.states)}"


def _counts(counts: dict[str, int]) -> str:
    return ", ".join(f"{name} {count}" for name, count in counts.items())


def cut(video: Path, annotations: Path, folder: Path, frames: int, width: int) -> tuple[Path, Path]:
    """The first `frames` frames, `width` px wide, and the annotations that lie before their end; paths in `folder`."""
    folder.mkdir(parents=True, exist_ok=True)
    end_s = _cut_video(video, folder / "clip.mp4", frames, width)
    found = json.loads(annotations.read_text(encoding="utf-8"))
    kept = {key: value for key, value in found.items() if float(key) < end_s}
    (folder / "clip.json").write_text(json.dumps(kept), encoding="utf-8")
    return folder / "clip.mp4", folder / "clip.json"


def _cut_video(video: Path, out: Path, frames: int, width: int) -> float:
    with av.open(str(video)) as source, av.open(str(out), "w") as target:
        rate = source.streams.video[0].average_rate
        shown = source.streams.video[0]
        height = round(shown.height * width / shown.width / 2) * 2
        stream = target.add_stream("libx264", rate=rate, options={"crf": "14", "threads": "1"})
        stream.width, stream.height, stream.pix_fmt = width, height, "yuv420p"
        for frame, _ in zip(source.decode(shown), range(frames), strict=False):
            small = frame.reformat(width, height, "yuv420p").to_ndarray()
            target.mux(stream.encode(av.VideoFrame.from_ndarray(small, format="yuv420p")))
        target.mux(stream.encode())
    return (frames - 0.5) / float(rate or 1)
