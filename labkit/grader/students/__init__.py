"""The students of the class, what they handed in, and which attempt counts."""
