"""Papers rebuilt: their numbers, figures and misprints, next to this program."""
