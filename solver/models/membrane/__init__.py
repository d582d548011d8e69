"""A membrane along its meridian, by FreeFEM."""
