"""What is done in turn to find a start: Python searches between, within its time, and so does the
FMU."""
