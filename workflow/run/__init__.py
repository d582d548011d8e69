"""What goes on around the jobs of a run: lock, progress, failures."""
