"""The report of an inspection: what a finished result says, in one document for people, as PDF, HTML, CSV and JSON."""
