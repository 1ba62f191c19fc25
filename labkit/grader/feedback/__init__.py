"""What is read of graded work: students' pages, the class report, one answer explained."""
