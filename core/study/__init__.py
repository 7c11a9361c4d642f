"""The study that asks people: its eight questions, their right answers, and the folder that people open."""
