"""Two reviews of each report by other students: who reads whose, and the sheet."""
