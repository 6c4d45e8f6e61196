"""The report: words, tables, figures, HTML and JSON."""
