"""Keypoints and descriptors: DISK (lazy descriptor head) and SIFT."""
