"""Records, what was measured, and what is made of both: dataset, tables of states, fields."""
