"""Studies of the course's makers: the reference controllers, the tasks, and what compares them."""
