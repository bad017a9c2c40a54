"""Files for other programs: tables, data frames, lines of mode shapes, motions, model files. No page."""
