"""Chapters on variants, designs and fits. No calculation."""
