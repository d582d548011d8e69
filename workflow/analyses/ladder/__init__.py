"""What every rung of the ladder of models is worth on muscles of all kinds."""
