"""One module per stage of the graph: thin adapters from a `StageTask` to the algorithms in `core`."""
