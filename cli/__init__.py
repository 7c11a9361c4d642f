"""The `bladeatlas` command."""
