"""What an instructor types: labkit's verbs, by the time of the term when they are used."""
