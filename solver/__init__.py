"""What is solved, the models that solve it, and the record of a solved case."""
