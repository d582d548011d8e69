"""Models of the muscle, one folder each, and what those with a mesh share."""
