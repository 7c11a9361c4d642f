"""The science of BladeAtlas: pure stages, their typed results and the stage graph.

Knows no database, no broker and no web framework.
"""
