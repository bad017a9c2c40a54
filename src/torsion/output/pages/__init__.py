"""Stand-alone reports of the commands joint, check and study."""
