"""Who is in the class, what they handed in, and which attempt counts."""
