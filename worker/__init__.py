"""Runs the plan: leases a task and executes its stage in a child process."""
