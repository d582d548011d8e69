"""The paper's claims, each judged by a small function of the states."""
