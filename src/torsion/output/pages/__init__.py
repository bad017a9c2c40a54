"""What a person reads: page, PDF, terminal, notebook. No number is selected here."""
