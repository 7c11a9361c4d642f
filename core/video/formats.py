"""What is read as a video: one list for the decoder, the messages and the documentation."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class VideoFormat:
    """One kind of file."""

    title: str
    """As people call it."""
    suffixes: tuple[str, ...]
    """Usual ends of its names. Nothing is told by them: the content decides."""
    demuxers: tuple[str, ...]
    """FFmpeg's names for it."""
    timeless: bool = False
    """Holds no times of its own: they are made from a frame rate."""


VIDEO_FORMATS: tuple[VideoFormat, ...] = (
    VideoFormat(
        "MP4, QuickTime", ("mp4", "mov", "m4v", "3gp", "3g2", "mj2"), ("mov", "mp4", "m4a", "3gp", "3g2", "mj2")
    ),
    VideoFormat("Matroska, WebM", ("mkv", "webm"), ("matroska", "webm")),
    VideoFormat("AVI", ("avi",), ("avi",)),
    VideoFormat("MPEG transport stream", ("ts", "mts", "m2ts"), ("mpegts",)),
    VideoFormat("MPEG program stream", ("mpg", "mpeg", "vob"), ("mpeg",)),
    VideoFormat("Flash video", ("flv",), ("flv",)),
    VideoFormat("Windows Media", ("asf", "wmv"), ("asf",)),
    VideoFormat("Ogg", ("ogv", "ogg"), ("ogg",)),
    VideoFormat("MXF", ("mxf",), ("mxf",)),
    VideoFormat("RealMedia", ("rm", "rmvb"), ("rm",)),
    VideoFormat("NUT", ("nut",), ("nut",)),
    VideoFormat("DV", ("dv",), ("dv",)),
    VideoFormat("GIF", ("gif",), ("gif",)),
    VideoFormat("YUV4MPEG2", ("y4m",), ("yuv4mpegpipe",)),
    VideoFormat("IVF", ("ivf",), ("ivf",)),
    VideoFormat("raw H.264", ("h264", "264"), ("h264",), timeless=True),
    VideoFormat("raw HEVC", ("hevc", "265"), ("hevc",), timeless=True),
    VideoFormat("raw AV1", ("obu",), ("obu",), timeless=True),
    VideoFormat("raw MPEG video", ("m1v", "m2v"), ("mpegvideo", "m4v"), timeless=True),
    VideoFormat("motion JPEG", ("mjpeg", "mjpg"), ("mjpeg",), timeless=True),
    VideoFormat("motion JPEG over HTTP", ("mpjpeg",), ("mpjpeg",), timeless=True),
)
"""Playlists are not among them: they would make the decoder read other files."""

_AUDIO = ("wav", "mp3", "aac", "flac")
"""Opened too, so that they can be named as what they are."""

FORMAT_WHITELIST = ",".join([*(name for one in VIDEO_FORMATS for name in one.demuxers), *_AUDIO])
"""FFmpeg's option of that name."""

TIMELESS = frozenset(name for one in VIDEO_FORMATS if one.timeless for name in one.demuxers)
"""Demuxers of formats without times."""

READABLE = ", ".join(one.title for one in VIDEO_FORMATS) + ", or a folder or zip of pictures"
"""All of it in one phrase."""

PICTURE_CODECS = {
    "png": "png",
    "jpg": "mjpeg",
    "jpeg": "mjpeg",
    "tif": "tiff",
    "tiff": "tiff",
    "bmp": "bmp",
}
"""Suffixes of the pictures that make a video, with FFmpeg's decoder. Here the suffix does decide."""
