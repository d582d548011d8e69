"""What single threads change."""
