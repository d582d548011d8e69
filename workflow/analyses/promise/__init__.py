"""Whether promises are kept, and at what cost, on random muscles."""
