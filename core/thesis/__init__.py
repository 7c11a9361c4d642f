"""The thesis's method: placing by sparse support, grouping by distance, its colours, and the tables of its results.

Placing and grouping stand behind the interfaces of `core.scene.methods`, as those of the product's own method do.
"""
