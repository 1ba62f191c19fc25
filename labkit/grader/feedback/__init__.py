"""What people read about graded work: students' pages, the class report, and `explain`."""
