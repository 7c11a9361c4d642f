"""Which source frames take part, and the pictures written of them."""
