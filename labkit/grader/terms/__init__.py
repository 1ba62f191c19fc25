"""A term: what is released and handed out in it, how it begins, and what is forgotten after it."""
