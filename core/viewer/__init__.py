"""The inspector's view of a result: its surface, its pictures, the document that the page reads, and the page."""
