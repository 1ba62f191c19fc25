"""A term: how it begins, what is released and handed out, and what is deleted afterwards."""
