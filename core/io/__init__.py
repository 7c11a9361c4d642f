"""The files between stages: each has one module here that reads and writes it and alone knows its name."""
