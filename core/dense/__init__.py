"""Dense stereo: undistortion, view selection, PatchMatch depth maps, geometric consistency, fusion."""
