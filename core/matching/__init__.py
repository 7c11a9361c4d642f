"""Which frames are paired, and how their keypoints are matched."""
