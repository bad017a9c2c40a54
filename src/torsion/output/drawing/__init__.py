"""From figures as data to SVG text: axes, lines, words that stay clear of each other, and keys."""
