"""Trains with closed loops: a spanning tree and the spans that close it."""
