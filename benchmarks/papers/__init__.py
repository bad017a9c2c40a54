"""Papers rebuilt: their numbers, figures and misprints, beside this program."""
