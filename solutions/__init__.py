"""The course's answers: ordinary typed Python, never installed, never in a student's reach."""
