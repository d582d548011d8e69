"""Threads: their law in both languages, and what a layer of them adds to a wall."""
