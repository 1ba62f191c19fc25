"""The gradebook, and the steps, pages and log of nbgrader's own commands."""
