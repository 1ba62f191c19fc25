"""The report, notebook 08."""
