"""Four papers rebuilt: their numbers, figures and misprints, beside this program."""
