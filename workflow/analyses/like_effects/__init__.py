"""What leaving out an effect changes on muscles of all kinds."""
