"""What leaving out an effect changes and saves."""
