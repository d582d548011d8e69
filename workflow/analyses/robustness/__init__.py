"""Where the models end: hard muscles and loads."""
