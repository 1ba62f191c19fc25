"""Vision: tags and the boards that carry them, cameras, and what a picture says."""
