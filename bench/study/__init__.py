"""What people did in the study: their records read, marked and, where there are enough, compared."""
