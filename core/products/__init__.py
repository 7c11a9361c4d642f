"""What stages hand on beside their files: one frozen type for each kind of task, written and read in `contract`."""
