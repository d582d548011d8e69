"""Whether the errors that are reported of a mesh cover the true ones, on random muscles."""
