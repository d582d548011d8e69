"""Time: loops, rates, a step of the supply, small vibrations, and the usual three elements."""
