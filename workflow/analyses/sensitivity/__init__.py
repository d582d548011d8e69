"""What of the settings the force depends on."""
