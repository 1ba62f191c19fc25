"""The Baxter Cup: entries run in the sandbox, and their table."""
