"""A uniform cylinder."""
