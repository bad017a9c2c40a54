"""What is printed on the terminal: tables of 80 columns."""
