"""From the fused cloud to the surface: Poisson meshing, support, PLY files."""
