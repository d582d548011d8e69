"""The study file: text with line numbers, schema, checks, units, sweeps."""
