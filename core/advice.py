"""What to do about each flag: one sentence of advice for whoever reads a result or made its video."""

from __future__ import annotations

from collections.abc import Mapping

_TRUST_NO_PLACE = "Do not trust a place or a size; film the part again"

FLAG_ADVICE: Mapping[str, str] = {
    "interval_clipped": (
        "Nothing, if the interval was only meant to reach the end; else set frames.clip_start_s and frames.clip_end_s."
    ),
    "truncated_video": "Copy the video from its recorder again; what comes after the damage was not looked at.",
    "times_repaired": (
        "Look whether events of the timeline lie where the video shows them; export the video again if not."
    ),
    "recording_joined": "Nothing, if the recordings show one part; else inspect each recording alone.",
    "video_stream_chosen": "If it is the wrong picture, name another with input.video_stream.",
    "damaged_pictures": "Nothing, if few; else copy or export the video again.",
    "times_made_up": "If times are wrong, tell the real frame rate with input.fps.",
    "interlaced": "Nothing; record progressive video if the instrument can, it keeps twice the detail.",
    "pixels_not_square": "Nothing, if circles look round in the frames; else export the video with square pixels.",
    "annotations_outside_video": "Check that the annotations are of this video and of this cut of it.",
    "annotations_partly_read": "Draw these shapes as boxes or polygons if they are damage, and run again.",
    "annotation_times_inexact": (
        "Look whether the boxes lie on their damage in the frames; if not, try another input.time_convention."
    ),
    "annotation_times_ambiguous": (
        "Look whether the boxes lie on their damage in the frames; if not, set input.time_convention."
    ),
    "still_pixels_masked": "Nothing; clean the lens before the next inspection if it is dirt.",
    "boxes_in_crop_frame": "Set mapping.box_frame to source, unless you repeat the thesis's figures.",
    "principal_point_at_crop_centre": "Set camera.principal_point to source, unless you repeat the thesis's figures.",
    "picture_jumps": "Take blade numbers beyond the jump as unknown; move the probe or the rotor more slowly.",
    "gap_spanned": "Compare a finding before and after the gap in the frames before you count it once.",
    "no_parallax": "Film again and move the probe sideways along the part instead of only turning it.",
    "bent_model": f"{_TRUST_NO_PLACE} slowly, with every place in several frames.",
    "parts_after_veto": "Use only what this part shows; inspect the frames outside it in the video.",
    "perspective_after_veto": (
        "Check some places in the overlay; set camera.model=SIMPLE_RADIAL if the lens is a perspective one."
    ),
    "weak_join": "Do not measure across the join, nor count blades over it; a slower pass there would mend it.",
    "row_irregular": "Take no place or size across what is named; find a part of the video that holds together.",
    "not_static": f"{_TRUST_NO_PLACE} while neither rotor nor probe tip bends or swings.",
    "two_motions": (
        "Check with the overlay which part the model follows; cut the other one off with the region of interest."
    ),
    "planar_start": "Check some places in the overlay before you measure; film again with more movement sideways.",
    "few_points": "Check places in the overlay before you measure; more light and slower motion give more points.",
    "coverage_low": "Look at the frames without a place in the video: nothing of them is on the surface.",
    "focal_uncertain": "Calibrate the lens (bladeatlas calibrate) or tell camera.fov_deg, then run again.",
    "lens_unknown": "Calibrate the lens (bladeatlas calibrate) or tell camera.fov_deg, then run again.",
    "lens_unsettled": (
        "Take shapes and sizes with caution; calibrate the lens or tell camera.fov_deg, then run again."
    ),
    "focal_lengths_differ": "Check that the video was not stretched when it was exported; then run again.",
    "focal_implausible": f"{_TRUST_NO_PLACE}, or calibrate the lens and run again.",
    "distortion_implausible": f"{_TRUST_NO_PLACE}, or calibrate the lens and run again.",
    "high_reprojection_error": (
        "Check places in the overlay before you measure; calibrate the lens if the surface lies beside the picture."
    ),
    "scale_unknown": (
        "Take no length in millimetres; tell a scale that this model holds, as a known length in one of its frames."
    ),
    "scale_disagrees": "Take no length in millimetres until the wrong one among the told scales is found.",
    "several_models": "Compare findings of different models in the frames before you count them as two.",
    "incomplete": "Run again from the stage named there; the files before it are right.",
    "no_surface": "Review the findings in the frames; film the part again from more sides for a surface.",
    "nothing_mapped": "Look at the reasons in the list of detections; check that the annotations are of this video.",
}
"""By code; every flag has one."""
