"""An oral examination on a student's own code, with a mistake put into it."""
