"""Cross-sections by mesh."""
