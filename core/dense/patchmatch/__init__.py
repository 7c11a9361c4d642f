"""PatchMatch multi-view stereo on the CPU: compiled kernels and the loop over scales."""
