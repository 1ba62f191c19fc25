"""The commands that an instructor types, grouped by when in the term they are used."""
