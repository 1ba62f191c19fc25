"""Studies by the authors of the course: reference controllers, tasks and comparisons."""
