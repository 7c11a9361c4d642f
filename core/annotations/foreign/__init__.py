"""Annotation files of other tools: told apart by content, read as they are, with a word on everything that is not."""
